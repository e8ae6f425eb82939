"""Robust weighted least squares for any list of causes, and its held-out score."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.fitting.held_out import left_out
from doormill_ros.diagnosis.core.fitting.problem import C, Prediction, Problem
from doormill_ros.diagnosis.core.fitting.ranking import QUANTUM, ranks
from doormill_ros.diagnosis.core.fitting.robust import robust_sum, same_left_out, trial_weights

STEPS = 25  #: of a descent, at most
RISE = 1e-6  #: share by which a step may raise the cost and still be taken
TRIES = 6  #: lengths of a step that are tried
SHORTER = 0.3  #: by how much each of them is shorter than the one before
SETTLED = 1e-6  #: squared standard deviations that a step moves everything by, below which a descent ends
PATIENT = 3  #: steps before gross errors are set aside
RIDGE = 1e-4  #: weak pull to zero effect, in squared inverse typical sizes


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
        held_out: Residual of each trial predicted without its fold, shape (n, c).
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


def fit(problem: Problem[C], members: Sequence[C], starts: Sequence[FloatArray] | None = None) -> Fit[C]:
    """Fit a model from the best of the starts given, shape (p,) each, or of its own."""
    members = tuple(members)
    starts = list(starts) if starts is not None else _starts(problem, members)
    best: tuple[float, FloatArray, FloatArray] | None = None
    if len(starts) > 2:
        # Laws with a kink have many valleys: a few steps from every start show which are worth following.
        starts = [descend(problem, members, theta, steps=2)[0] for theta in starts]
        costs = [robust_sum(problem.predict(members, theta).cost) for theta in starts]
        starts = [starts[i] for i in ranks(np.array(costs))[:2]]
    for theta in starts:
        found, weights = descend(problem, members, theta)
        score = robust_sum(problem.predict(members, found).cost)
        if best is None or score < best[0] - QUANTUM:
            best = (score, found, weights)
    assert best is not None  # starts is never empty
    return finish(problem, members, best[1], best[2], best[0])


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


def normal_equations(prediction: Prediction, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Hessian (p, p) and descent (p,) of half the weighted cost."""
    hessian, descent = _sums(prediction.derived, prediction.white, weights)
    if prediction.spread is not None:
        rows, slope = prediction.spread
        more, pull = _sums(slope, rows, weights)
        hessian, descent = hessian + more, descent + pull
    return hessian, descent


def _sums(jacobian: FloatArray, white: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """J^T W J (p, p) and J^T W r (p,) of derivatives (n, c, p), residuals (n, c) and weights (n,)."""
    # As one product of matrices, which the linear algebra does ten times as fast as sums over three indices.
    n, c, p = jacobian.shape
    rows = jacobian.reshape(n * c, p)
    weighted = (jacobian * weights[:, None, None]).reshape(n * c, p)
    return weighted.T @ rows, weighted.T @ white.reshape(n * c)


def descend(
    problem: Problem[C],
    members: tuple[C, ...],
    theta: FloatArray,
    steps: int = STEPS,
    fixed: int | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Walk downhill from theta, shape (p,), one number fixed where wanted: theta and the weights (n,) there."""
    lower, upper = bounds(members)
    scale = np.concatenate([np.zeros(0)] + [c.scale for c in members])
    ridge = RIDGE / scale**2
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
        for _ in range(TRIES):
            moved = np.clip(theta + move, lower, upper)
            trial = problem.predict(members, moved, derivative=True)
            if float(weights @ trial.cost) <= objective + RISE * abs(objective):
                break
            move = SHORTER * move
        change = moved - theta
        theta, prediction = moved, trial
        settled = float(change @ (hessian @ change)) < SETTLED
        before, weights = (
            weights,
            trial_weights(prediction.cost, step >= PATIENT or settled, problem.components),
        )
        if settled and step >= 1 and same_left_out(before, weights):
            break
    return theta, weights


def _rows(prediction: Prediction, rows: BoolArray) -> Prediction:
    """What a model says of some trials, marked in (n,)."""
    spread = prediction.spread
    return Prediction(
        prediction.residual[rows],
        prediction.white[rows],
        prediction.cost[rows],
        prediction.derived[rows],
        None if spread is None else (spread[0][rows], spread[1][rows]),
    )


def finish(
    problem: Problem[C], members: tuple[C, ...], theta: FloatArray, weights: FloatArray, score: float
) -> Fit[C]:
    """Covariance and held-out residuals by one exact step away from theta, shape (p,), with weights, shape (n,)."""
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
    hessian = hessian + np.diag(RIDGE / scale**2)
    free = (theta > lower) & (theta < upper)
    covariance = np.zeros_like(hessian)
    if free.any():
        covariance[np.ix_(free, free)] = np.linalg.inv(hessian[np.ix_(free, free)])
    held_white = prediction.white.copy()
    # A number at a kink hangs on the few trials beside it; a linear step away from it means nothing.
    smooth = free & ~np.concatenate([np.isin(np.arange(c.size), c.kinked) for c in members])
    folds = [problem.folds == fold for fold in range(problem.folds.max() + 1)] if smooth.any() else []
    parts = (normal_equations(_rows(prediction, rows), weights[rows]) for rows in folds)
    for rows, step in zip(
        folds,
        # At the fit the descent of all rows vanishes.
        left_out(
            hessian,
            np.zeros_like(theta),
            parts,
            lambda H, g: np.linalg.solve(H[np.ix_(smooth, smooth)], g[smooth]),
        ),
        strict=True,
    ):
        change = np.zeros_like(theta)
        change[smooth] = step
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
