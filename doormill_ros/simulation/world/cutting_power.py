"""Power that the wood takes from a spindle: what is cut from it in a second, times the work that this takes.

The same model as that of the forces (`engagement`): an edge is held back in proportion to its chip, so the work of a
turn is the volume that it takes. Nothing here is the project's own: neither the forces that targets are corrected for
nor its model of the cut.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import inverse
from doormill_ros.recipes.recipe import Recipe

#: Work to cut a volume of wood [J/m^3]: chipboard 32.0 N/mm^2 at 40 m/s (Palubicki, Materials 14 (2021) 2208).
SPECIFIC = 32e6
CELL = 5e-4  #: of the map of what is gone [m]
STEP = 1e-3  #: ways of the tip below this are left until they are longer [m]
ROOM = 256  #: cells by which the map grows


class CutDoor:
    """How much of a door is left, as a mill goes through it."""

    def __init__(self, recipe: Recipe, T_base_door: FloatArray) -> None:
        """Keep a whole door that stands at T_base_door, shape (4, 4)."""
        self._features = {
            feature.id: (inverse(T_base_door @ recipe.T_door_feature(feature)), feature.tool.radius)
            for feature in recipe.features
        }
        self._radii = {name: tool.radius for name, tool in recipe.tools.items()}
        self._slabs: dict[str, CutSlab] = {}
        self._last = np.full(3, np.inf)

    def take(self, feature: str, tip: FloatArray, tool: str = "") -> float:
        """Put the mill with its tip somewhere.

        Args:
            feature: In hand; empty, or one that the recipe does not know, for a way through the air.
            tip: Base frame, shape (3,) [m].
            tool: In the spindle; another mill than the recipe knows is that of the feature.

        Returns:
            Volume of the wood that is gone for it [m^3].
        """
        if feature not in self._features or np.linalg.norm(tip - self._last) < STEP:
            return 0.0
        self._last = tip
        T_feature_base, radius = self._features[feature]
        place = T_feature_base[:3, :3] @ tip + T_feature_base[:3, 3]
        if place[2] <= 0.0:
            return 0.0
        slab = self._slabs.setdefault(feature, CutSlab())
        return slab.take(place, self._radii.get(tool, radius))


class CutSlab:
    """How deep the wood is gone under one surface, on a grid that grows with the cut."""

    def __init__(self) -> None:
        """A whole slab."""
        self._low = np.zeros(2, dtype=int)
        self._gone = np.zeros((0, 0))

    def take(self, tip: FloatArray, radius: float) -> float:
        """Put a mill with its tip here.

        Args:
            tip: z into the wood, its surface at 0, shape (3,) [m].
            radius: Of the mill [m].

        Returns:
            Volume of the wood that is gone for it [m^3].
        """
        reach = int(np.ceil(radius / CELL)) + 1
        at = np.floor(tip[:2] / CELL).astype(int)
        self._make_room(at - reach, at + reach + 1)
        rows, columns = (np.arange(k - reach, k + reach + 1) for k in at)
        x, y = ((cells + 0.5) * CELL - tip[axis] for axis, cells in enumerate((rows, columns)))
        i, j = at - reach - self._low
        part = self._gone[i : i + len(rows), j : j + len(columns)]
        lost = np.where(x[:, None] ** 2 + y[None, :] ** 2 < radius**2, np.maximum(tip[2] - part, 0.0), 0.0)
        part += lost
        return float(CELL**2 * lost.sum())

    def _make_room(self, low: FloatArray, high: FloatArray) -> None:
        """Let the grid hold cells from `low` to before `high`, shape (2,) each."""
        if not self._gone.size:
            self._low = low.copy()
        before = np.where(low < self._low, self._low - low + ROOM, 0)
        end = self._low + self._gone.shape
        after = np.where(high > end, high - end + ROOM, 0)
        if before.any() or after.any():
            self._gone = np.pad(self._gone, list(zip(before, after, strict=True)))
            self._low = self._low - before
