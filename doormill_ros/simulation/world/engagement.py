"""Cutting forces from the wood that stands before the tool, not from a table.

An edge at the angle psi from the feed takes a chip of the thickness c cos(psi) and is held back along its way and
pushed towards the tool's axis in proportion to chip and depth (linear edge force model, Altintas, Manufacturing
Automation, chapter 2). The mean over a turn is the integral over the part of the rim that meets wood. Of what the
project assumes one figure is used: a full slot at the recipe's depth of cut takes the largest force of the feature.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import inverse
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath

RADIAL = 0.3  #: force towards the axis over force along the edge's way
CELL = 2.5e-4  #: of the map of what is gone [m]
AVERAGED = 1e-3  #: way over which a force is the mean [m]
LONGEST = 2e-3  #: steps above this are not along one cut [m]
STILL = 1e-9  #: ways along the surface below this are none [m]


def engaged_wrench(recipe: Recipe, T_base_door: FloatArray, path: ExecutedPath) -> FloatArray:
    """Wrench of the wood on the tool at its tip.

    Args:
        recipe: The door.
        T_base_door: Where it stands, shape (4, 4).
        path: What the controller commanded, with the wrenches that the targets were corrected for.

    Returns:
        Base axes, shape (n, 6) [N, N m]; no force along the tool axis and no moment.
    """
    wrench = np.zeros((len(path.time), 6))
    for feature in recipe.features:
        rows = np.flatnonzero(path.cutting & (path.feature == feature.id))
        if not len(rows):
            continue
        T_base_feature = T_base_door @ recipe.T_door_feature(feature)
        surface = T_base_feature[:3, :2]
        tip = (inverse(T_base_feature) @ path.T_base_tool_commanded[rows])[:, :3, 3]
        full_slot = np.linalg.norm(path.wrench[rows, :3] @ surface, axis=1).max()
        deepest = min(feature.passes.depth_step, feature.cut_depth(recipe.size))
        wrench[rows, :3] = full_slot * slot_share(tip, feature.tool.radius, deepest) @ surface.T
    return wrench


def slot_share(tip: FloatArray, radius: float, depth: float) -> FloatArray:
    """Force along a path over the size of the force in a full slot.

    Args:
        tip: Tool tips in the order of time, z into the wood, its surface at 0, shape (n, 3) [m].
        radius: Of the tool [m].
        depth: Of the full slot [m].

    Returns:
        Along x and y of the surface, shape (n, 2); the spindle turns from x to y.
    """
    wood = _Wood(tip, radius)
    way = np.concatenate([[0.0], np.linalg.norm(np.diff(tip[:, :2], axis=0), axis=1)])
    # A strip of the rim sweeps cos(psi) of its length times the way: the wood that is lost there is the chip already.
    chip = np.array([wood.take(one) for one in tip])
    # What is lost on the way down, or after a way through the air, is no chip of a rim that moves along the surface.
    jump = way > LONGEST
    chip[(way < STILL) | jump] = 0.0
    way[jump] = 0.0
    sums, ways = np.cumsum(chip, axis=0), np.cumsum(way)
    # Cells are coarse: the mean over some of them, growing from 0 where a cut begins.
    begun = np.maximum.accumulate(np.where(jump, np.arange(len(tip)), 0))
    before = np.maximum(np.searchsorted(ways, ways - AVERAGED, side="right") - 1, begun)
    passed = np.maximum(ways - ways[before], AVERAGED)
    x, y = np.where(way < STILL, 0.0, (sums - sums[before]).T / passed)
    # In a full slot the integral over the rim is pi / 2 times depth, along the edge's way and towards the axis.
    whole = np.pi / 2.0 * depth * np.hypot(1.0, RADIAL) * radius
    share: FloatArray = -np.column_stack([-y + RADIAL * x, x + RADIAL * y]) / whole
    return share


class _Wood:
    """How deep the wood is gone already, on a grid over one feature."""

    def __init__(self, tip: FloatArray, radius: float) -> None:
        self._reach = int(np.ceil(radius / CELL)) + 1
        self._radius = radius
        self._low = tip[:, :2].min(axis=0) - (self._reach + 1) * CELL
        size = np.ceil((tip[:, :2].max(axis=0) - self._low) / CELL).astype(int) + self._reach + 2
        self._gone = np.zeros(tuple(size))

    def take(self, tip: FloatArray) -> FloatArray:
        """Put the tool with its tip here, shape (3,).

        Returns:
            Volume of the lost wood, each cell's along the unit vector to it from the tool's axis, shape (2,) [m^3].
        """
        i, j = np.floor((tip[:2] - self._low) / CELL).astype(int)
        rows, columns = (np.arange(k - self._reach, k + self._reach + 1) for k in (i, j))
        x, y = (self._low[k] + (cells + 0.5) * CELL - tip[k] for k, cells in enumerate((rows, columns)))
        part = self._gone[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        lost = (x[:, None] ** 2 + y[None, :] ** 2 < self._radius**2) & (part < tip[2])
        at = np.argwhere(lost)
        offset = np.column_stack([x[at[:, 0]], y[at[:, 1]]])
        taken = CELL**2 * (tip[2] - part[lost])
        part[lost] = tip[2]
        length = np.maximum(np.linalg.norm(offset, axis=1, keepdims=True), CELL / 2.0)
        chips: FloatArray = taken @ (offset / length)
        return chips
