"""Series, causes and the normal equations of every block of rows.

The residual is very nearly linear in all causes, so one pass over the data gives, for every block, all that
later fits, cross-validations and comparisons of causes need: sums of products of derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.ridge import Block
from doormill_ros.measurements.pose_set import PoseSet, placement_owners
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

    def frames(self, series: int, x: FloatArray | None = None, rows: IntArray | None = None) -> FloatArray:
        """Displaced frames of a series or some rows of it, shape (n, J + 1, 4, 4)."""
        x = self.x if x is None else x
        rows = np.arange(len(self.sets[series])) if rows is None else rows
        bases = {key: (ids, basis[rows]) for key, (ids, basis) in self.bases[series].items()}
        return frames(self.views[series].transforms[rows], frame_twists(bases, x, len(rows), self.joints))

    def residual(self, series: int, x: FloatArray | None = None) -> FloatArray:
        """Residual with the current placement, base axes, shape (n, 6)."""
        data = self.sets[series]
        return residual(self.frames(series, x), self.placements[series], data.position, data.rotation)

    def blocks(
        self, rows: Sequence[Sequence[IntArray]], progress: Callable[[int], None] = lambda n: None
    ) -> list[Block]:
        """Normal equations of blocks of rows, shape (k,) each, given for every series."""
        found = []
        for series, parts in enumerate(rows):
            T = self.frames(series)
            data, placement = self.sets[series], self.placements[series]
            error = residual(T, placement, data.position, data.rotation)
            for part in parts:
                found.append(self._block(series, part, T[part], error[part]))
                progress(len(part))
        return found

    def _block(self, series: int, rows: IntArray, T: FloatArray, error: FloatArray) -> Block:
        weight = self.share * self.weights[series][rows]
        scale = self.scale(series) * np.sqrt(weight)[:, None]
        D = derivatives(T, self.placements[series]) * scale[:, None, :]
        bases = {key: (ids, basis[rows]) for key, (ids, basis) in self.bases[series].items()}
        own = self.placement_ids(series)
        one = np.ones((len(rows), 1))
        for key, column in zip(self.free[series], own, strict=True):
            ids, basis = bases.get(key, (np.zeros(0, dtype=int), np.zeros((len(rows), 0))))
            bases[key] = (np.append(ids, column), np.concatenate([basis, one], axis=1))
        keys = sorted(bases)
        S = np.einsum("nac,nbc->abn", D[:, keys], D[:, keys])
        order = np.concatenate([bases[key][0] for key in keys])
        at = np.concatenate([[0], np.cumsum([len(bases[key][0]) for key in keys])])
        H = np.empty((len(order), len(order)))
        y = np.einsum("nac,nc->an", D[:, keys], error * scale)
        g = np.empty(len(order))
        for a, key in enumerate(keys):
            left = bases[key][1]
            here = slice(at[a], at[a + 1])
            g[here] = left.T @ y[a]
            for b in range(a, len(keys)):
                there = slice(at[b], at[b + 1])
                H[here, there] = left.T @ (S[a, b][:, None] * bases[keys[b]][1])
                H[there, here] = H[here, there].T
        ids, place = np.unique(order, return_inverse=True)
        if len(ids) < len(order):  # one coefficient in several directions
            once = np.zeros((len(ids), len(order)))
            once[place, np.arange(len(order))] = 1.0
            order, H, g = ids, once @ H @ once.T, once @ g
        x = np.concatenate([self.x, np.zeros(self.size - self.layout.size)])[order]
        c = float(np.sum((error * scale) ** 2)) + float(x @ (2.0 * g + H @ x))
        return Block(series, rows, order, H, g + H @ x, c, float(weight.sum()))
