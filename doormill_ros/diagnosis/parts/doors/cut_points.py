"""Measured points of a door, each with the robot's state where it was cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.correction.loads import Loads


@dataclass(frozen=True, eq=False)
class CutPoints:
    """Measured points and the robot's state where each was cut.

    Attributes:
        point: Points of the nominal surface, base frame, shape (n, 3) [m].
        normal: Unit normals into the wood, base axes, shape (n, 3).
        deviation: Wood missing along the normal, shape (n,) [m]; negative where wood is left.
        sent: How far along the normal the tool's surface had been sent beyond the nominal one, shape (n,) [m].
        behind: How far behind the tip, along the spindle, the tool cut the point, shape (n,) [m].
        wall: Which points lie on a wall, the others on a floor; shape (n,).
        q: Commanded joint angles where the point was cut, shape (n, 6) [rad].
        direction: Last motion of each joint there, shape (n, 6).
        wrench: Assumed process wrench at the tool's tip, base axes, shape (n, 6) [N, N m].
        spread: How well that is known, as in `Loads`, shape (n, 6, 6) [N, N m].
        bounded: Where nobody measured it, shape (n,).
        bend: Curvature of the tool's way there, towards its centre, base axes, shape (n, 3) [1 / m].
        late: How far beside it the tool passes that follows late by each of `LAGS`, base axes, shape (n, lags, 3) [m].
        feed: Speed of the tool there, shape (n,) [m / s].
        row: Of each point among those of its inspection, counted from 0, shape (n,).
        feature, kind: Name in the recipe and kind of the feature of each point, shape (n,).
        tool: Name of the tool that cut it, shape (n,).
    """

    point: FloatArray
    normal: FloatArray
    deviation: FloatArray
    sent: FloatArray
    behind: FloatArray
    wall: BoolArray
    q: FloatArray
    direction: FloatArray
    wrench: FloatArray
    spread: FloatArray
    bounded: BoolArray
    bend: FloatArray
    late: FloatArray
    feed: FloatArray
    row: IntArray
    feature: np.ndarray[tuple[int], np.dtype[np.str_]]
    kind: np.ndarray[tuple[int], np.dtype[np.str_]]
    tool: np.ndarray[tuple[int], np.dtype[np.str_]]

    def __len__(self) -> int:
        return len(self.deviation)

    def __getitem__(self, rows: BoolArray | slice) -> Self:
        """Some of the points."""
        return type(self)(*(getattr(self, field.name)[rows] for field in fields(self)))

    @property
    def loads(self) -> Loads:
        """The wrenches, as a plan has them."""
        return Loads(self.wrench, self.direction, self.spread, self.bounded, self.kind)

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Several sets of points as one."""
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(cls)))
