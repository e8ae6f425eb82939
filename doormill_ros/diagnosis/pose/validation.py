"""Cross-validation of a fit: contiguous blocks left out, whole series left out, causes taken away."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.held_out import left_out
from doormill_ros.diagnosis.core.ridge import Block, Solution, add_up, learn, without
from doormill_ros.diagnosis.pose.fit import BLOCKS, Fitted
from doormill_ros.diagnosis.pose.placement import rows_needed
from doormill_ros.robot_model.pose.chain import derivatives

#: Every so many-th block of each series is left out together.
FOLDS = 5
#: Rounds in which the typical sizes are learnt anew without the part left out.
ROUNDS = 1
#: Rows that place a series left out when the set marks too few: every so many-th, yet at least so many.
_EVERY, _LEAST = 25, 12
#: Damping of a placement: directions that the poses leave open stay where they are.
_WHISPER = 3e-5
ALL_AXES, AXES_OF_POSITION = slice(0, 6), slice(0, 3)


@dataclass(frozen=True, eq=False)
class Split:
    """One part of the data left out.

    Attributes:
        rows: Left-out rows of every series (empty where none), one array a series.
        solution: Coefficients that have not seen them.
        series: The whole series that was left out, or None for blocks.
    """

    rows: tuple[IntArray, ...]
    solution: Solution
    series: int | None


class Validation:
    """Solutions with parts left out, and the residuals they leave there."""

    def __init__(self, fitted: Fitted) -> None:
        """Solve once for every part left out; typical sizes are learnt anew without it."""
        self.fitted = fitted
        problem = fitted.problem
        self._linear = [_Linear(fitted, series) for series in range(len(problem.sets))]
        seen: dict[int, int] = {}
        fold = []
        for block in fitted.blocks:
            seen[block.series] = seen.get(block.series, -1) + 1
            fold.append(seen[block.series] % FOLDS)
        folds = [[b for b, at in zip(fitted.blocks, fold, strict=True) if at == k] for k in range(FOLDS)]
        parts = (add_up(part, problem.size) for part in folds)
        others = left_out(*add_up(fitted.blocks, problem.size), parts, self._learnt)
        self.blocks = [self._split(*pair) for pair in zip(folds, others, strict=True)]
        self.series = []
        for series in range(len(problem.sets)) if len(problem.sets) > 1 else ():
            # Its placement vanishes with it, of which a difference of sums would leave the rounding.
            others_alone = add_up([b for b in fitted.blocks if b.series != series], problem.size)
            own = [b for b in fitted.blocks if b.series == series]
            self.series.append(self._split(own, self._learnt(*others_alone), series))

    def _learnt(self, H: FloatArray, g: FloatArray) -> Solution:
        """The solution of some rows, shapes (m, m) and (m,)."""
        return learn(H, g, self.fitted.problem.layout, ROUNDS, self.fitted.solution.variance)

    def _split(self, part: Sequence[Block], solution: Solution, series: int | None = None) -> Split:
        """What was left out, with the solution that has not seen it."""
        empty = np.zeros(0, dtype=int)
        rows = tuple(
            np.concatenate([empty, *(block.rows for block in part if block.series == s)])
            for s in range(len(self.fitted.problem.sets))
        )
        return Split(rows, solution, series)

    def less(self, ids: IntArray) -> Validation:
        """The same with coefficients, shape (k,), held at zero."""
        smaller = copy(self)
        smaller.blocks = [replace(split, solution=without(split.solution, ids)) for split in self.blocks]
        smaller.series = [replace(split, solution=without(split.solution, ids)) for split in self.series]
        return smaller

    @cached_property
    def left(self) -> float:
        """The held-out cost that all causes together leave."""
        full = self.cost(self.residuals(self.blocks, np.zeros(0, dtype=int)))
        return sum(float(np.sum(part)) for part in full)

    def residuals(self, splits: Sequence[Split], removed: IntArray) -> list[FloatArray]:
        """Residual of every row by the split that left it out, base axes, shape (n, 6), with coefficients removed."""
        problem = self.fitted.problem
        out = [np.zeros((len(data), 6)) for data in problem.sets]
        for split in splits:
            x = without(split.solution, removed).x
            for series, rows in enumerate(split.rows):
                if len(rows):
                    linear = self._linear[series]
                    placed = linear.place(x) if split.series is not None and not linear.shared else x
                    out[series][rows] = linear.residual(placed, rows)
        return out

    def variance(self, split: Split, series: int, rows: IntArray) -> FloatArray:
        """Variance of predicted positions of rows from what is uncertain in a split's solution, shape (n, 3) [m^2]."""
        return self._linear[series].variance(split.solution, rows, split.series is not None)

    def cost(self, errors: Sequence[FloatArray], axes: slice = ALL_AXES) -> list[FloatArray]:
        """Weighted squares of every row in noise units, shape (n,) each; of some of its six components."""
        problem = self.fitted.problem
        return [
            weight * np.sum((error * problem.scale(series))[:, axes] ** 2, axis=1)
            for series, (error, weight) in enumerate(zip(errors, problem.weights, strict=True))
        ]


class _Linear:
    """Residuals of a series as a linear function of the coefficients."""

    def __init__(self, fitted: Fitted, series: int) -> None:
        problem = fitted.problem
        self.size = problem.layout.size
        self.own = problem.placement_ids(series)
        self.error = problem.residual(series)
        self.D = derivatives(problem.frames(series), problem.placements[series])
        self.bases = problem.bases[series]
        self.x = problem.x
        self.scale = problem.scale(series)
        self.free = problem.free[series]
        self.shared = problem.owner.count(problem.owner[series]) > 1
        marked = np.flatnonzero(problem.sets[series].placement & (problem.weights[series] > 0.0))
        every = max(1, min(_EVERY, len(self.error) // _LEAST))
        enough = len(marked) >= rows_needed(problem.sets[series].oriented)
        self.placing = marked if enough else np.arange(0, len(self.error), every)
        self.weight = problem.weights[series]

    def residual(self, x: FloatArray, rows: IntArray) -> FloatArray:
        """Residual with all coefficients and the placement in x, shape (len(rows), 6)."""
        step = x[: self.size] - self.x
        twists = np.zeros((len(rows), self.D.shape[1]))
        for key, (ids, basis) in self.bases.items():
            part = step[ids]
            if np.any(part):
                twists[:, key] = basis @ part if len(rows) == len(basis) else basis[rows] @ part
        twists[:, self.free] += x[self.own]
        result: FloatArray = self.error[rows] - np.einsum("na,nac->nc", twists, self.D[rows])
        return result

    def effect(self, rows: IntArray, count: int, axes: int) -> FloatArray:
        """Derivatives of the first axes of the poses of rows by all unknowns, shape (len(rows), axes, count)."""
        A = np.zeros((len(rows), axes, count))
        for key, (ids, basis) in self.bases.items():
            A[:, :, ids] += self.D[rows, key, :axes, None] * basis[rows][:, None, :]
        A[:, :, self.own] = np.swapaxes(self.D[rows][:, self.free, :axes], 1, 2)
        return A

    def variance(self, solution: Solution, rows: IntArray, placed: bool) -> FloatArray:
        """Of predicted positions of rows, shape (len(rows), 3) [m^2]; `placed` if marked rows alone place the series.

        Then the placement takes up a part of what is wrong in the coefficients, and adds the noise of those rows.
        """
        A, C = self.effect(rows, len(solution.x), 3), solution.covariance
        noise = np.zeros((len(rows), 3))
        if placed and not self.shared:
            marked = self.effect(self.placing, len(solution.x), 6) * self.scale[:, None]
            marked = marked.reshape(-1, len(solution.x))
            P = marked[:, self.own]
            unit = 1.0 / np.linalg.norm(P, axis=0)
            inverse = np.linalg.inv((P * unit).T @ (P * unit) + _WHISPER**2 * np.eye(len(unit)))
            inverse *= np.outer(unit, unit)
            own = A[:, :, self.own]
            noise = np.sum((own @ inverse) * own, axis=2)
            A = A - own @ (inverse @ (P.T @ marked))
            A[:, :, self.own] = 0.0
        used = np.flatnonzero(np.any(A, axis=(0, 1)))
        A = A[:, :, used]
        result: FloatArray = np.sum((A @ C[np.ix_(used, used)]) * A, axis=2) + noise
        return result

    def place(self, x: FloatArray) -> FloatArray:
        """The same coefficients with the placement fitted to the rows that may place the series."""
        x = x.copy()
        x[self.own] = 0.0
        rows = self.placing
        J = self.D[rows][:, self.free] * self.scale
        for _ in range(3):
            error = self.residual(x, rows) * self.scale
            size = np.linalg.norm(error, axis=1)
            root = np.sqrt(self.weight[rows] / np.maximum(1.0, size / (2.5 * np.median(size))))
            # Base and target hardly differ in few poses: by orthogonal steps, which lose half the digits of a sum.
            A = (J * root[:, None, None]).transpose(0, 2, 1).reshape(-1, len(self.own))
            unit = 1.0 / np.linalg.norm(A, axis=0)
            whole = np.vstack([A * unit, _WHISPER * np.eye(len(self.own))])
            right = np.concatenate([(error * root[:, None]).ravel(), np.zeros(len(self.own))])
            x[self.own] += unit * np.linalg.lstsq(whole, right, rcond=None)[0]
        return x


def by_block(cost: Sequence[FloatArray]) -> list[FloatArray]:
    """Sums over the contiguous blocks of every series, shape (10,) each, of costs of rows, shape (n,)."""
    return [np.array([part.sum() for part in np.array_split(one, BLOCKS)]) for one in cost]


def held_out_fall(before: Validation, after: Validation) -> tuple[FloatArray, float]:
    """Fall of the cost of blocks left out from one fit to another, by block, and what the other leaves.

    Both in standard deviations of what the other leaves, rows weighed as by the fit that trusts them less.

    Returns:
        Shape (blocks of all series,), and a sum.
    """
    none = np.zeros(0, dtype=int)
    problem = after.fitted.problem
    weights = zip(before.fitted.problem.weights, problem.weights, strict=True)
    weight = [np.minimum(one, other) for one, other in weights]
    costs = [
        [
            w * np.sum((error * problem.scale(series)) ** 2, axis=1)
            for series, (w, error) in enumerate(zip(weight, fit.residuals(fit.blocks, none), strict=True))
        ]
        for fit in (before, after)
    ]
    fall = by_block([a - b for a, b in zip(*costs, strict=True)])
    return np.concatenate(fall), sum(float(part.sum()) for part in costs[1])
