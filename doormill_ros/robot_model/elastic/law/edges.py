"""Bolted faces that open: a foot or a tool's seat tips over one edge by the moment about it, and only that way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import cross
from doormill_ros.robot_model.elastic.load_case import LoadCase
from doormill_ros.units import deg_to_rad

_FRAMES = {"base": 0, "tool": 6}
#: How far from the middle of a face an edge may lie [m]; a seat's is small, and its edge all but through it.
_WIDTHS = {"base": (0.1, 0.2, 0.3, 0.4, 0.5, 0.6), "tool": (0.0,)}
#: Steps between directions of edges [deg]: those that are tried, and those between that may do better.
_ROUGH, _FINE = 15, 5


@dataclass(frozen=True)
class Edge:
    """An edge of a face.

    Attributes:
        where: Base or tool.
        way: In which direction from the middle of the face it lies, about its z [deg].
        width: How far away [m].
    """

    where: str
    way: int
    width: float
    kind: ClassVar[str] = "tipping"

    @property
    def _words(self) -> str:
        return (
            f"the edge {self.width:g} m towards {self.way} deg"
            if self.width
            else f"its edge at {self.way} deg"
        )

    @property
    def acts_on(self) -> str:
        """What a term acts on that tips over it."""
        return f"{self.where} over {self._words}"

    @property
    def driver(self) -> str:
        """What drives that."""
        return f"wrench (moment over {self._words} of the {self.where})"

    @property
    def does(self) -> str:
        """What it does."""
        return f"tips over {self._words}"

    def _line(self, case: LoadCase) -> tuple[FloatArray, FloatArray]:
        """Axis, and the edge from the frame's origin, shape (n, 3) each; positive lifts the far side."""
        axes = case.axes[:, _FRAMES[self.where]]
        c, s = np.cos(deg_to_rad(self.way)), np.sin(deg_to_rad(self.way))
        return axes @ np.array([-s, c, 0.0]), axes @ np.array([self.width * c, self.width * s, 0.0])

    def motion(self, case: LoadCase, where: str) -> list[FloatArray]:
        """One radian about it, shape (n, 6)."""
        axis, away = self._line(case)
        frame = _FRAMES[self.where]
        first = max(frame, 1)
        twist = case.rotate(axis, frame, first)
        twist[:, :3] -= np.where((case.link >= first)[:, None], cross(axis, away), 0.0)
        return [twist]

    def moment(self, case: LoadCase, joint: int) -> FloatArray:
        """Moment of the load that lifts the far side, shape (n,) [N m]; 0 where it presses it down."""
        axis, away = self._line(case)
        about = case.moment[:, _FRAMES[self.where]] - cross(away, case.force)
        result: FloatArray = np.maximum(np.sum(axis * about, axis=1), 0.0)
        return result

    def beside(self) -> list[Edge]:
        """Those next to it that a model may have."""
        widths = _WIDTHS[self.where]
        at = widths.index(self.width)
        turned = [Edge(self.where, (self.way + step) % 360, self.width) for step in (-_FINE, _FINE)]
        return [
            *turned,
            *(Edge(self.where, self.way, widths[i]) for i in (at - 1, at + 1) if 0 <= i < len(widths)),
        ]


#: All edges by what a term acts on, and those that are tried first.
EDGES = {
    edge.acts_on: edge
    for where, widths in _WIDTHS.items()
    for width in widths
    for edge in (Edge(where, way, width) for way in range(0, 360, _FINE))
}
ROUGH = tuple(edge for edge in EDGES.values() if edge.way % _ROUGH == 0 and edge.width in (0.0, 0.2, 0.4))
