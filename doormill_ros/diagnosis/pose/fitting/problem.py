"""Series, causes, and the numbers at which they stand.

The residual is very nearly linear in all causes, so one pass over the data gives all that later fits,
cross-validations and comparisons of causes need.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.pose.fitting.linear import Linear
from doormill_ros.diagnosis.pose.fitting.placement import rows_needed
from doormill_ros.measurements.sets.pose_set import PoseSet, placement_owners
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.chain import (
    Placement,
    derivatives,
    frames,
    free_directions,
    per_axis,
    residual,
)
from doormill_ros.robot_model.pose.layout import design, frame_twists, lay_out

#: Rows that place a series left out when the set marks too few: every so many-th, yet at least so many.
_EVERY, _LEAST = 25, 12


class PoseProblem:
    """Several series and a set of causes.

    Attributes:
        sets, views: The series.
        layout: The causes.
        x: Current coefficients, shape (m,).
        placements: Current placement of every series.
        sigmas: Current standard deviation per axis of every series, position [m] and rotation [rad].
        weights: Of the rows of every series, 0 for gross errors.
        owner: Index of the first series with the same placement, of every series.
        free: Directions of its placement, of every series; a point on the flange where nobody measured orientation.
        share: Part of the rows that count: what is left of neighbouring rows has common causes, and a thousand
            poses that err alike tell no more than a hundred that err by chance.
    """

    def __init__(
        self, sets: Sequence[PoseSet], causes: Sequence[PoseCause], placements: Sequence[Placement]
    ) -> None:
        """Prepare, without any cause acting."""
        self.sets = tuple(sets)
        self.views = [one.view for one in sets]
        self.layout = lay_out(causes)
        self.bases = [design(view, self.layout) for view in self.views]
        self.x = np.zeros(self.layout.size)
        self.placements = list(placements)
        self.sigmas = [(1e-4, 2e-4)] * len(self.sets)
        self.weights = [np.ones(len(one)) for one in sets]
        self.share = 1.0
        self.owner = placement_owners(self.sets)
        self.joints = self.sets[0].joints
        oriented = [
            any(one.oriented for one, other in zip(self.sets, self.owner, strict=True) if other == mine)
            for mine in self.owner
        ]
        self.free = [free_directions(self.joints, seen) for seen in oriented]
        self.placements = [self.placements[own] for own in self.owner]
        sizes = [len(free) if self.owner[i] == i else 0 for i, free in enumerate(self.free)]
        self._start = self.layout.size + np.concatenate([[0], np.cumsum(sizes, dtype=int)])

    @property
    def size(self) -> int:
        """All unknowns: causes, and a placement for every series that has its own."""
        return int(self._start[-1])

    def placement_ids(self, series: int) -> IntArray:
        """Indices of the placement of a series, in the order of its `free`, shape (9,) or (12,)."""
        return int(self._start[self.owner[series]]) + np.arange(len(self.free[series]))

    def scale(self, series: int) -> FloatArray:
        """One over the standard deviation of every component of a series' residual, shape (6,)."""
        return per_axis(self.sigmas[series], self.sets[series].oriented)

    def move(self, step: FloatArray) -> None:
        """Shift every placement by its part of a solution of all unknowns, shape (size,)."""
        for series, own in enumerate(self.owner):
            if own == series:
                twist = np.zeros(12)
                twist[: len(self.free[series])] = step[self.placement_ids(series)]
                self.placements[series] = self.placements[series].moved(twist[:6], twist[6:])
            else:
                self.placements[series] = self.placements[own]

    def at(self, x: FloatArray) -> PoseProblem:
        """The same with the coefficients and steps of the placements of a solution, shape (size,)."""
        other = copy(self)
        other.x, other.placements = x[: self.layout.size].copy(), list(self.placements)
        other.move(x)
        return other

    def frames(self, series: int, x: FloatArray | None = None) -> FloatArray:
        """Displaced frames of a series, shape (n, J + 1, 4, 4)."""
        x = self.x if x is None else x
        twists = frame_twists(self.bases[series], x, len(self.sets[series]), self.joints)
        return frames(self.views[series].transforms, twists)

    def residual(self, series: int, x: FloatArray | None = None) -> FloatArray:
        """Residual with the current placement, base axes, shape (n, 6)."""
        data = self.sets[series]
        return residual(self.frames(series, x), self.placements[series], data.position, data.rotation)

    def linear(self, series: int) -> Linear:
        """A series linearised at the current numbers."""
        data, placement, weight = self.sets[series], self.placements[series], self.weights[series]
        T = self.frames(series)
        marked = np.flatnonzero(data.placement & (weight > 0.0))
        every = max(1, min(_EVERY, len(data) // _LEAST))
        return Linear(
            series,
            residual(T, placement, data.position, data.rotation),
            derivatives(T, placement),
            self.bases[series],
            np.concatenate([self.x, np.zeros(self.size - self.layout.size)]),
            self.free[series],
            self.placement_ids(series),
            self.scale(series),
            weight,
            self.share,
            marked if len(marked) >= rows_needed(data.oriented) else np.arange(0, len(data), every),
            self.owner.count(self.owner[series]) > 1,
        )
