"""Cross-validation of a fit: contiguous blocks left out, whole series left out, causes taken away."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.held_out import left_out
from doormill_ros.diagnosis.core.fitting.ridge import Solution, add_up, held, learn, without
from doormill_ros.diagnosis.pose.fitting.fit import BLOCKS, Fitted
from doormill_ros.diagnosis.pose.fitting.placed import place, variance

#: Rounds in which the typical sizes are learnt anew without the part left out.
ROUNDS = 1
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
        size, folds, count = fitted.problem.size, fitted.folds, len(fitted.problem.sets)
        parts = (add_up(part, size) for part in folds)
        others = left_out(*fitted.whole, parts, self._learnt)
        self.blocks = [
            Split(tuple(block.rows for block in part), solution, None)
            for part, solution in zip(folds, others, strict=True)
        ]
        self.series = []
        for series in range(count) if count > 1 else ():
            # Its placement vanishes with it, of which a difference of sums would leave the rounding.
            others_alone = add_up((b for part in folds for b in part if b.series != series), size)
            rows = [np.arange(len(one.error) if one.series == series else 0) for one in fitted.linear]
            self.series.append(Split(tuple(rows), self._learnt(*others_alone), series))

    def _learnt(self, H: FloatArray, g: FloatArray) -> Solution:
        """The solution of some rows, shapes (m, m) and (m,)."""
        return learn(H, g, self.fitted.problem.layout, ROUNDS, self.fitted.solution.variance)

    def less(self, ids: IntArray) -> Validation:
        """The same with coefficients, shape (k,), held at zero; what all causes together leave stays that."""
        smaller = copy(self)
        smaller.left = self.left
        smaller.blocks = [replace(split, solution=without(split.solution, ids)) for split in self.blocks]
        smaller.series = [replace(split, solution=without(split.solution, ids)) for split in self.series]
        return smaller

    @cached_property
    def left(self) -> float:
        """The held-out cost that all causes together leave."""
        return sum(float(np.sum(part)) for part in self.cost(self.residuals(self.blocks)))

    def residuals(self, splits: Sequence[Split]) -> list[FloatArray]:
        """Residual of every row by the split that left it out, base axes, shape (n, 6)."""
        return next(self.residuals_less(splits, [np.zeros(0, dtype=int)]))

    def residuals_less(
        self, splits: Sequence[Split], removed: Sequence[IntArray]
    ) -> Iterator[list[FloatArray]]:
        """The same for each of some choices of coefficients, shape (k,), that are held at zero."""
        found = [np.zeros((len(removed), len(one.error), 6)) for one in self.fitted.linear]
        for split in splits:
            x = np.stack([held(split.solution, ids) for ids in removed])
            for one, rows in zip(self.fitted.linear, split.rows, strict=True):
                if len(rows):
                    placed = place(one, x) if split.series is not None and not one.shared else x
                    for block in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1):
                        found[one.series][:, block] = one.residuals(placed, block)
        for choice in range(len(removed)):
            yield [one[choice] for one in found]

    def variance(self, split: Split, series: int, rows: IntArray) -> FloatArray:
        """Variance of predicted positions of rows from what is uncertain in a split's solution, shape (n, 3) [m^2]."""
        return variance(self.fitted.linear[series], split.solution, rows, split.series is not None)

    def cost(self, errors: Sequence[FloatArray], axes: slice = ALL_AXES) -> list[FloatArray]:
        """Weighted squares of every row in noise units, shape (n,) each; of some of its six components."""
        problem = self.fitted.problem
        return [
            weight * np.sum((error * problem.scale(series))[:, axes] ** 2, axis=1)
            for series, (error, weight) in enumerate(zip(errors, problem.weights, strict=True))
        ]


def by_block(cost: Sequence[FloatArray]) -> list[FloatArray]:
    """Sums over the contiguous blocks of every series, shape (10,) each, of costs of rows, shape (n,)."""
    return [np.array([part.sum() for part in np.array_split(one, BLOCKS)]) for one in cost]


def held_out_fall(before: Validation, after: Validation) -> tuple[FloatArray, float]:
    """Fall of the cost of blocks left out from one fit to another, by block, and what the other leaves.

    Both in standard deviations of what the other leaves, rows weighed as by the fit that trusts them less.

    Returns:
        Shape (blocks of all series,), and a sum.
    """
    problem = after.fitted.problem
    weights = zip(before.fitted.problem.weights, problem.weights, strict=True)
    weight = [np.minimum(one, other) for one, other in weights]
    costs = [
        [
            w * np.sum((error * problem.scale(series)) ** 2, axis=1)
            for series, (w, error) in enumerate(zip(weight, fit.residuals(fit.blocks), strict=True))
        ]
        for fit in (before, after)
    ]
    fall = by_block([a - b for a, b in zip(*costs, strict=True)])
    return np.concatenate(fall), sum(float(part.sum()) for part in costs[1])
