"""A fit of poses less the causes that left it, and what it leaves of rows that it has and has not seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.held_out import scatter_of
from doormill_ros.diagnosis.core.fitting.ridge import Solution, without
from doormill_ros.diagnosis.core.words import verdict
from doormill_ros.diagnosis.pose.fitting.fit import Fitted, contiguous
from doormill_ros.diagnosis.pose.fitting.noise import left_over
from doormill_ros.diagnosis.pose.fitting.problem import PoseProblem
from doormill_ros.diagnosis.pose.fitting.validation import Validation
from doormill_ros.measurements.sets.pose_set import PoseSet
from doormill_ros.robot_model.pose.causes.cause import PoseCause


@dataclass(frozen=True, eq=False)
class Errors:
    """Residuals of every row of every series in base axes, shape (n, 6) each."""

    train: list[FloatArray]
    blocks: list[FloatArray]
    series: list[FloatArray]


@dataclass(frozen=True, eq=False)
class SeriesFit:
    """Causes that are left of a fit.

    Attributes:
        members: The causes.
        fitted: The fit, with those that left it since.
        validation: Solutions with parts of the data left out, the causes that left held at zero.
    """

    members: tuple[PoseCause, ...]
    fitted: Fitted
    validation: Validation

    @cached_property
    def problem(self) -> PoseProblem:
        """Series, causes, coefficients, placements and weights; the causes that left do not act."""
        whole = self.fitted.problem
        if len(self.members) == len(whole.layout.causes):
            return whole
        rest = whole.at(self.solution.x)
        errors = [rest.residual(i) for i in range(len(rest.sets))]
        rest.sigmas = left_over(rest.sets, errors)
        return rest

    @cached_property
    def solution(self) -> Solution:
        """Coefficients with covariance and learnt sizes; those of causes that left held at zero."""
        causes = self.fitted.problem.layout.causes
        return without(self.fitted.solution, self.ids([one for one in causes if one not in self.members]))

    @property
    def parts(self) -> list[tuple[PoseCause, slice]]:
        """Its causes, each with where its coefficients are."""
        layout = self.fitted.problem.layout
        places = ((cause, layout.part(index)) for index, cause in enumerate(layout.causes))
        return [(cause, part) for cause, part in places if cause in self.members]

    def ids(self, causes: Sequence[PoseCause]) -> IntArray:
        """Coefficients of some causes, shape (k,)."""
        layout = self.fitted.problem.layout
        every = np.arange(layout.size)
        return np.concatenate([every[:0], *(every[layout.part(layout.causes.index(c))] for c in causes)])

    @cached_property
    def errors(self) -> Errors:
        """What it leaves of every row."""
        validation = self.validation
        return Errors(
            [self.problem.residual(i) for i in range(len(self.problem.sets))],
            validation.residuals(validation.blocks),
            validation.residuals(validation.series) if validation.series else [],
        )


def rmse(errors: Sequence[FloatArray], kept: Sequence[BoolArray], rotation: bool = False) -> float:
    """Root mean square length of the position [m] or rotation [rad] error, shape (n, 6), over the rows that count."""
    part = slice(3, 6) if rotation else slice(0, 3)
    return verdict.rmse(np.concatenate(errors)[:, part], np.concatenate(kept), 1)


def figures(
    sets: Sequence[PoseSet], errors: Sequence[FloatArray], kept: Sequence[BoolArray]
) -> tuple[float, float | None]:
    """Root mean square of the position error [m] and of the rotation [rad], None where no set has an orientation.

    Args:
        sets: The series.
        errors: Their residuals, shape (n, 6) each.
        kept: Rows that count, shape (n,) each.
    """
    turned = [i for i, data in enumerate(sets) if data.oriented]
    return rmse(errors, kept), (
        rmse([errors[i] for i in turned], [kept[i] for i in turned], rotation=True) if turned else None
    )


def standard_deviations(fit: SeriesFit) -> FloatArray:
    """Of every coefficient: of the fit, or from the scatter of the blocks where that is larger, shape (m,)."""
    size, solution = fit.problem.size, fit.solution
    pulls = []
    for one in fit.fitted.linear:
        for pull, _ in one.pulls(solution.x, contiguous(len(one.error))):
            whole = np.zeros(size)
            whole[one.ids] = pull
            pulls.append(whole)
    scatter = scatter_of(np.array(pulls), solution.covariance)
    m = fit.problem.layout.size
    result: FloatArray = np.maximum(np.sqrt(np.diag(solution.covariance)), scatter)[:m]
    return result


def distinct_share(fitted: Fitted) -> FloatArray:
    """Share of every coefficient's effect that no placement can imitate, shape (m,)."""
    m = fitted.problem.layout.size
    H, _ = fitted.whole
    P = H[m:, m:] + 1e-12 * np.diag(np.diag(H)[m:])
    explained = np.sum(H[:m, m:] * np.linalg.solve(P, H[m:, :m]).T, axis=1)
    result: FloatArray = 1.0 - explained / np.maximum(np.diag(H)[:m], 1e-300)
    return result
