"""Robust weighted least squares for any list of causes, and its held-out score."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.problem import C, Prediction, Problem
from doormill_ros.diagnosis.core.ranking import QUANTUM, ranks
from doormill_ros.statistics import CHI_SQUARE_MEDIAN, GROSS_SHARE, huber_weights

GROSS = 30.0  #: squared distance of a trial beyond which it may be a gross error (chance 1e-6)
_HUBER = 4.0  #: standard deviations up to which a trial keeps its full weight
_KINKS = 16  #: values at which a kinked number is tried
_NOTHING = 2.7  #: fall of the score below which a kinked number may as well be zero (one in ten)
_RIDGE = 1e-4  #: weak pull to zero effect, in squared inverse typical sizes


#: What tells models apart: name, place and variant of every member.
Identity = frozenset[tuple[str, str, str]]


@dataclass(frozen=True, eq=False)
class Fit(Generic[C]):
    """A model that was fitted to all trials.

    Attributes:
        members: Causes.
        theta: Fitted numbers, shape (p,).
        covariance: Their covariance, shape (p, p); zero for numbers that sit on a bound.
        prediction: At theta, with Jacobian.
        weights: Weight of each trial, shape (n,); 0 for those set aside.
        score: Robust sum of squared distances.
        held_out: Residual of each trial predicted without its fold, shape (n, 3) [m].
        held_out_cost: Cost of each trial predicted without its fold, shape (n,).
        held_out_score: Robust sum of those.
        free: Numbers that do not sit on a bound, shape (p,).
    """

    members: tuple[C, ...]
    theta: FloatArray
    covariance: FloatArray
    prediction: Prediction
    weights: FloatArray
    score: float
    held_out: FloatArray
    held_out_cost: FloatArray
    held_out_score: float
    free: BoolArray

    @property
    def size(self) -> int:
        """Number of fitted numbers."""
        return len(self.theta)

    @property
    def identity(self) -> Identity:
        """Identities of the members, whatever their order."""
        return frozenset(cause.identity for cause in self.members)

    def part(self, cause: C) -> slice:
        """Where a member's numbers stand in theta."""
        at = 0
        for member in self.members:
            if member is cause:
                return slice(at, at + member.size)
            at += member.size
        raise KeyError(cause)


def robust_sum(cost: FloatArray) -> float:
    """Sum of costs, shape (n,), in which the worst tenth counts no more than GROSS each."""
    ordered = np.sort(cost)[::-1]
    spared = int(GROSS_SHARE * len(cost))
    return float(np.minimum(ordered[:spared], GROSS).sum() + ordered[spared:].sum())


def trial_weights(distance: FloatArray, reject: bool, components: int = 3) -> FloatArray:
    """Huber weights of squared distances, shape (n,); with `reject` gross errors get zero."""
    scale2 = max(1.0, float(np.median(distance)) / CHI_SQUARE_MEDIAN[components])
    size = np.sqrt(np.maximum(distance / scale2, 1e-12))
    weights = huber_weights(size, _HUBER)
    spared = int(GROSS_SHARE * len(distance))
    if reject and spared:
        worst = np.argsort(-distance, kind="stable")[:spared]
        weights[worst[distance[worst] > GROSS * scale2]] = 0.0
    return weights


def fit(problem: Problem[C], members: Sequence[C], starts: Sequence[FloatArray] | None = None) -> Fit[C]:
    """Fit a model from the best of the starts given, shape (p,) each, or of its own."""
    members = tuple(members)
    starts = list(starts) if starts is not None else _starts(problem, members)
    best: tuple[float, FloatArray, FloatArray] | None = None
    if len(starts) > 2:
        # Laws with a kink have many valleys: a few steps from every start show which are worth following.
        starts = [_descend(problem, members, theta, steps=2)[0] for theta in starts]
        costs = [robust_sum(problem.predict(members, theta).cost) for theta in starts]
        starts = [starts[i] for i in ranks(np.array(costs))[:2]]
    for theta in starts:
        found, weights = _descend(problem, members, theta)
        score = robust_sum(problem.predict(members, found).cost)
        if best is None or score < best[0] - QUANTUM:
            best = (score, found, weights)
    assert best is not None  # starts is never empty
    return _finish(problem, members, best[1], best[2], best[0])


def score_without(
    problem: Problem[C], members: Sequence[C], starts: Sequence[FloatArray], index: int
) -> float:
    """Score of a model in which one number stays at zero, the best from several starts.

    Args:
        problem: The set.
        members: Causes.
        starts: Each of shape (p,).
        index: The number that stays at zero.
    """
    scores = []
    for start in starts:
        theta = np.array(start, dtype=float)
        theta[index] = 0.0
        theta, _ = _descend(problem, tuple(members), theta, fixed=index)
        scores.append(robust_sum(problem.predict(members, theta).cost))
    return min(scores)


def _starts(problem: Problem[C], members: tuple[C, ...]) -> list[FloatArray]:
    starts = [np.zeros(0)]
    for cause in members:
        starts = [np.concatenate([theta, part]) for theta in starts for part in cause.starts(problem.case)]
    return starts


def bounds(members: Sequence[C]) -> tuple[FloatArray, FloatArray]:
    """Allowed range of theta, two arrays of shape (p,)."""
    none = [np.zeros(0)]
    return (
        np.concatenate(none + [cause.lower for cause in members]),
        np.concatenate(none + [cause.upper for cause in members]),
    )


def polish(problem: Problem[C], found: Fit[C]) -> Fit[C]:
    """Walk numbers with a kinked cost over all their kinks; a descent stops at the next one.

    A number that may as well be zero becomes zero: a gap is a step until the data say otherwise.
    The other numbers follow in two steps each.
    """
    for cause in found.members:
        for i in cause.kinked:
            index = found.part(cause).start + i
            size = cause.kinks(problem.case)
            values = np.unique(np.append(np.quantile(size, np.linspace(0.0, 1.0, _KINKS)), 0.0))
            tried = [(robust_sum(found.prediction.cost), found.theta)]
            for value in values:
                theta = found.theta.copy()
                theta[index] = value
                theta, _ = _descend(problem, found.members, theta, steps=2, fixed=index)
                tried.append((robust_sum(problem.predict(found.members, theta).cost), theta))
            score, theta = tried[ranks(np.array([cost for cost, _ in tried]))[0]]
            at_zero = next(pair for pair in tried if pair[1][index] == 0.0 and pair is not tried[0])
            if at_zero[0] < score + _NOTHING:
                found = _finish(problem, found.members, at_zero[1], found.weights, at_zero[0])
            elif theta is not found.theta:
                again = fit(problem, found.members, [theta])
                found = again if again.score < found.score - QUANTUM else found
    return found


def normal_equations(prediction: Prediction, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Hessian (p, p) and descent (p,) of half the weighted cost."""
    jacobian, white = prediction.derived, prediction.white
    weighted = jacobian * weights[:, None, None]
    hessian = np.einsum("nip,niq->pq", weighted, jacobian)
    descent = np.einsum("nip,ni->p", weighted, white)
    if prediction.spread is not None:
        rows, slope = prediction.spread
        weighted = slope * weights[:, None, None]
        hessian = hessian + np.einsum("nip,niq->pq", weighted, slope)
        descent = descent + np.einsum("nip,ni->p", weighted, rows)
    return hessian, descent


def _descend(
    problem: Problem[C],
    members: tuple[C, ...],
    theta: FloatArray,
    steps: int = 25,
    fixed: int | None = None,
) -> tuple[FloatArray, FloatArray]:
    lower, upper = bounds(members)
    scale = np.concatenate([np.zeros(0)] + [c.scale for c in members])
    ridge = _RIDGE / scale**2
    prediction = problem.predict(members, theta, derivative=True)
    weights = trial_weights(prediction.cost, False, problem.components)
    for step in range(steps):
        hessian, descent = normal_equations(prediction, weights)
        descent = descent - ridge * theta
        free = ~(((theta <= lower) & (descent < 0.0)) | ((theta >= upper) & (descent > 0.0)))
        if fixed is not None:
            free[fixed] = False
        if not free.any():
            break
        move = np.zeros_like(theta)
        matrix = (hessian + np.diag(ridge))[np.ix_(free, free)]
        move[free] = np.linalg.solve(matrix, descent[free])
        objective = float(weights @ prediction.cost)
        for _ in range(6):
            moved = np.clip(theta + move, lower, upper)
            trial = problem.predict(members, moved, derivative=True)
            if float(weights @ trial.cost) <= objective + 1e-6 * abs(objective):
                break
            move = 0.3 * move
        change = moved - theta
        theta, prediction = moved, trial
        settled = float(change @ (hessian @ change)) < 1e-6
        weights = trial_weights(prediction.cost, step >= 3 or settled, problem.components)
        if settled and step >= 1:
            break
    return theta, weights


def _finish(
    problem: Problem[C], members: tuple[C, ...], theta: FloatArray, weights: FloatArray, score: float
) -> Fit[C]:
    """Covariance and held-out residuals by one exact step away from the fit to all trials."""
    prediction = problem.predict(members, theta, derivative=True)
    if not members:
        cost = prediction.cost
        return Fit(
            members,
            theta,
            np.zeros((0, 0)),
            prediction,
            trial_weights(cost, True, problem.components),
            score,
            problem.measured_part(prediction.white),
            cost,
            score,
            np.zeros(0, dtype=bool),
        )
    lower, upper = bounds(members)
    scale = np.concatenate([np.zeros(0)] + [c.scale for c in members])
    hessian, _ = normal_equations(prediction, weights)
    hessian = hessian + np.diag(_RIDGE / scale**2)
    free = (theta > lower) & (theta < upper)
    covariance = np.zeros_like(hessian)
    if free.any():
        covariance[np.ix_(free, free)] = np.linalg.inv(hessian[np.ix_(free, free)])
    held_white = prediction.white.copy()
    # A number at a kink hangs on the few trials beside it; a linear step away from it means nothing.
    smooth = free & ~np.concatenate([np.isin(np.arange(c.size), c.kinked) for c in members])
    for fold in range(problem.folds.max() + 1):
        rows = problem.folds == fold
        if not smooth.any():
            break
        part = Prediction(
            prediction.residual[rows],
            prediction.white[rows],
            prediction.cost[rows],
            prediction.derived[rows],
            None if prediction.spread is None else (prediction.spread[0][rows], prediction.spread[1][rows]),
        )
        own_hessian, own_descent = normal_equations(part, weights[rows])
        matrix = (hessian - own_hessian)[np.ix_(smooth, smooth)]
        change = np.zeros_like(theta)
        change[smooth] = np.linalg.solve(matrix, -own_descent[smooth])
        change = np.clip(theta + change, lower, upper) - theta
        held_white[rows] -= prediction.derived[rows] @ change
    held_cost = prediction.cost + np.sum(held_white**2, axis=1) - np.sum(prediction.white**2, axis=1)
    held_out = problem.measured_part(held_white)
    return Fit(
        members,
        theta,
        covariance,
        prediction,
        weights,
        score,
        held_out,
        held_cost,
        robust_sum(held_cost),
        free,
    )
