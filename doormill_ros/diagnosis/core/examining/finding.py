"""One established cause: its size, how sure that is, and what would do as well."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.examining.examination import Double, Examination
from doormill_ros.diagnosis.core.fitting.fit import Fit, bounds, normal_equations
from doormill_ros.diagnosis.core.fitting.problem import C, Problem
from doormill_ros.diagnosis.core.searching.beam import BeamSearch
from doormill_ros.diagnosis.core.words.verdict import rmse

_STEP = 1e-6  #: share of a number by which it is moved to derive what is reported


@dataclass(frozen=True, eq=False)
class Finding(Generic[C]):
    """One established cause.

    Attributes:
        cause: The cause.
        values, std: Reported parameters and their standard deviations, in a row.
        equals: Other causes that would do as well.
        without: Held-out RMSE of the extended model less this cause.
        rivals: All alternatives in its place with their held-out scores, the best first.
    """

    cause: C
    values: FloatArray
    std: FloatArray
    equals: tuple[Double[C, Fit[C]], ...]
    without: float
    rivals: tuple[tuple[C, float], ...]

    @property
    def confusable(self) -> tuple[C, ...]:
        """Other causes that would do as well."""
        return tuple(equal.cause for equal in self.equals)

    @property
    def tied(self) -> tuple[C, ...]:
        """Those of them between which and the named one the data say nothing at all."""
        return tuple(equal.cause for equal in self.equals if equal.tied)


def make_findings(
    search: BeamSearch[C],
    examination: Examination[C, Fit[C]],
    structure: bool,
    told: Fit[C] | None = None,
) -> tuple[Finding[C], ...]:
    """All established causes, each sized also in the models where equals stand for the others.

    Args:
        search: All models.
        examination: The best of them, and what is named.
        structure: Whether something remains unexplained; uncertainties then grow with it.
        told: The model whose numbers are told, where that is not the best of the search: one of the causes and laws.
    """
    established, doubles = examination.named, examination.doubles
    findings = []
    for i, cause in enumerate(established):
        alternatives = [
            equal.model
            for j, others in enumerate(doubles)
            for equal in others
            if j != i and equal.model is not None and any(member is cause for member in equal.model.members)
        ]
        away = [_values(search.problem, model, cause) for model in alternatives]
        findings.append(_make_finding(search, examination, cause, structure, doubles[i], away, told))
    return tuple(findings)


def _make_finding(
    search: BeamSearch[C],
    examination: Examination[C, Fit[C]],
    cause: C,
    structure: bool,
    same: Sequence[Double[C, Fit[C]]],
    alternatives: Sequence[FloatArray],
    told: Fit[C] | None,
) -> Finding[C]:
    """Size a cause of the best model, its uncertainty and what could stand in its place.

    Args:
        search: All models.
        examination: The best of them, and what is named.
        cause: The member to report.
        structure: Whether something remains unexplained; uncertainties then grow with it.
        same: What would do as well in its place.
        alternatives: Values of this cause beside an equal of another one, shape (v,) each.
        told: As of `make_findings`.
    """
    problem, best = search.problem, examination.best if told is None else told
    part = best.part(cause)
    theta = best.theta[part]
    covariance = best.covariance[part, part]
    if structure:
        good = best.weights > 0.0
        covariance = covariance * float(np.mean(best.prediction.cost[good])) / problem.components
    values = cause.values(theta, problem.case)
    slope = np.zeros((len(values), cause.size))
    for i in range(cause.size):
        step = _STEP * max(abs(theta[i]), cause.scale[i])
        moved = theta.copy()
        moved[i] += step
        slope[:, i] = (cause.values(moved, problem.case) - values) / step
    std = np.sqrt(np.clip(np.diag(slope @ covariance @ slope.T), 0.0, None))
    for i in cause.kinked:
        std[i] = abs(slope[i, i]) * profile_std(problem, best, part.start + i)
    for other in alternatives:
        # Which of two equal models holds is a toss-up: its own value counts half.
        away = other - _values(problem, examination.best, cause)
        std = np.sqrt(std**2 + 0.5 * away**2)
    return Finding(
        cause=cause,
        values=values,
        std=std,
        equals=tuple(same),
        without=rmse(
            search.without(examination.extended, cause).held_out, examination.kept, problem.components
        ),
        rivals=tuple(
            (other, found.held_out_score) for other, found in search.rivals(examination.best, cause)
        ),
    )


def _values(problem: Problem[C], found: Fit[C], cause: C) -> FloatArray:
    """Reported parameters of a member, shape (v,)."""
    return cause.values(found.theta[found.part(cause)], problem.case)


def profile_std(problem: Problem[C], found: Fit[C], index: int) -> float:
    """Standard deviation of one number from how far it can move until the cost has risen by 4.

    The others follow to first order. For numbers in which the cost has kinks, or that sit on
    zero, where the curvature says nothing.
    """
    lower, upper = bounds(found.members)
    others = found.free.copy()
    others[index] = False
    weights = found.weights

    def cost(value: float) -> float:
        theta = found.theta.copy()
        theta[index] = value
        for _ in range(2):
            prediction = problem.predict(found.members, theta, derivative=True)
            if not others.any():
                break
            matrix, descent = normal_equations(prediction, weights)
            matrix = matrix[np.ix_(others, others)] + 1e-12 * np.eye(int(others.sum()))
            theta[others] += np.linalg.solve(matrix, descent[others])
            theta = np.clip(theta, lower, upper)
        return float(weights @ problem.predict(found.members, theta).cost)

    start = float(found.theta[index])
    least = float(weights @ found.prediction.cost)
    reach = []
    for end in (lower[index], upper[index]):
        before = (0.0, 0.0)
        reach.append(abs(end - start))
        for value in start + (end - start) * np.geomspace(1e-3, 1.0, 25):
            rise = cost(value) - least
            if rise > 4.0:
                share = (4.0 - before[1]) / max(rise - before[1], 1e-9)
                reach[-1] = before[0] + share * (abs(value - start) - before[0])
                break
            before = (abs(value - start), max(rise, 0.0))
    return float(max(reach)) / 2.0
