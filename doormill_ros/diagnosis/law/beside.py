"""Fits and previews of terms beside established columns that are projected out once: a term costs its own columns.

The theorem of Frisch, Waugh and Lovell: the numbers of terms T beside columns B are those of what B leaves of T and of
the target. Steps, weights and folds are those of `core.fit`; only the sums of products over B are not formed anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.fit import (
    PATIENT,
    RIDGE,
    RISE,
    SETTLED,
    SHORTER,
    STEPS,
    TRIES,
    Fit,
    bounds,
    fit,
)
from doormill_ros.diagnosis.core.fitting.problem import Prediction
from doormill_ros.diagnosis.core.fitting.ranking import QUANTUM
from doormill_ros.diagnosis.core.fitting.robust import robust_sum, same_left_out, trial_weights
from doormill_ros.diagnosis.core.searching.preview import Slopes
from doormill_ros.diagnosis.law.linear import Established, LinearProblem
from doormill_ros.diagnosis.law.projection import Projection, Weighted


class Beside:
    """Terms beside established columns of a linear problem."""

    def __init__(self, problem: LinearProblem, base: Established) -> None:
        """Project the columns out of the target.

        Args:
            problem: What is left to explain.
            base: What stays.
        """
        self._problem, self._base = problem, base
        columns = problem.slope(base, np.zeros(base.size)).reshape(-1, base.size)
        self._projection = Projection(columns, RIDGE / base.scale**2)
        self._target = (problem.target / problem.sigma).reshape(-1)
        self._left = self._projection.left(self._target)
        self._terms: dict[int, tuple[Any, FloatArray, FloatArray]] = {}
        self._slopes: tuple[Slopes[Any], FloatArray, list[FloatArray]] | None = None

    def _columns(self, terms: Sequence[Any]) -> tuple[FloatArray, FloatArray]:
        """Whitened columns of terms, and what the established ones leave of them, shape (c n, t) each."""
        for term in terms:
            if id(term) not in self._terms:
                own = self._problem.slope(term, np.zeros(term.size)).reshape(-1, term.size)
                self._terms[id(term)] = (term, own, self._projection.left(own))
        none = np.zeros((len(self._target), 0))
        found = [self._terms[id(term)] for term in terms]
        return np.hstack([none, *(own for _, own, _ in found)]), np.hstack([none, *(e for _, _, e in found)])

    def _weighted(self, weights: FloatArray) -> Weighted:
        """Of weights of the rows of the problem, shape (n,)."""
        return Weighted(self._projection, np.repeat(weights, self._problem.components))

    def fit(self, members: Sequence[Any], starts: Sequence[FloatArray] | None = None) -> Fit[Any]:
        """As `core.fit` does, from starts of shape (p,) each; the covariance is not known.

        Args:
            members: The established columns, then terms.
            starts: Where to start from; zero without any.
        """
        members, size = tuple(members), self._base.size
        lower, upper = bounds(members)
        if members[:1] != (self._base,) or any(member.kinked for member in members):
            return fit(self._problem, members, starts)
        best: tuple[float, FloatArray, FloatArray, FloatArray] | None = None
        for start in [np.zeros(len(lower))] if starts is None else starts:
            theta, white, weights = self._descend(members, start)
            score = robust_sum(self._cost(white))
            if best is None or score < best[0] - QUANTUM:
                best = (score, theta, white, weights)
        assert best is not None  # starts is never empty
        score, theta, white, weights = best
        if np.any((theta <= lower[size:]) | (theta >= upper[size:])):
            return fit(self._problem, members, starts)
        return self._finish(members, score, theta, white, weights)

    def _cost(self, white: FloatArray) -> FloatArray:
        """Of every row, shape (n,), of whitened residuals, shape (c n,)."""
        result: FloatArray = np.sum(white.reshape(-1, self._problem.components) ** 2, axis=1)
        return result

    def _descend(
        self, members: Sequence[Any], start: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Numbers of the terms (t,), residuals (c n,) and weights (n,) where the steps of `core.fit.descend` end."""
        size = self._base.size
        columns, left = self._columns(members[1:])
        pull = _pull(members[1:])
        theta = start[size:]
        white = self._target - self._projection.columns @ start[:size] - columns @ theta
        cost = self._cost(white)
        weights = trial_weights(cost, False, self._problem.components)
        for step in range(STEPS):
            weighted = self._weighted(weights)
            hessian = weighted.product(columns, left, left) + np.diag(pull)
            move = np.linalg.solve(hessian, weighted.product(columns, left, self._left)) - theta
            change = weighted.residual(self._left - left @ (theta + move)) - white
            objective = float(weights @ cost)
            for turn in range(TRIES):
                share = SHORTER**turn
                moved = white + share * change
                cost = self._cost(moved)
                if float(weights @ cost) <= objective + RISE * abs(objective):
                    break
            theta, change, white = theta + share * move, moved - white, moved
            settled = float(weights @ self._cost(change)) < SETTLED
            before, weights = (
                weights,
                trial_weights(cost, step >= PATIENT or settled, self._problem.components),
            )
            if settled and step >= 1 and same_left_out(before, weights):
                break
        return theta, white, weights

    def _finish(
        self,
        members: tuple[Any, ...],
        score: float,
        theta: FloatArray,
        white: FloatArray,
        weights: FloatArray,
    ) -> Fit[Any]:
        """Held-out residuals by one exact step away from where a descent ended; shapes as `_descend`."""
        problem, count = self._problem, self._problem.components
        columns, left = self._columns(members[1:])
        pull = _pull(members[1:])
        weighted = self._weighted(weights)
        own = weighted.residual(left)
        spread = np.linalg.inv(weighted.product(columns, left, left) + np.diag(pull))
        folds = np.repeat(problem.folds, count)
        blocks = [np.flatnonzero(folds == fold) for fold in range(folds.max() + 1)]
        held, each = white.copy(), np.repeat(weights, count)
        for rows, hat in zip(blocks, weighted.hats(blocks), strict=True):
            # By what the fit makes of these rows itself, r (1 - hat)^-1 is what it leaves of them without them.
            own_hat = hat + own[rows] @ spread @ own[rows].T
            held[rows] = np.linalg.solve(np.eye(len(rows)) - own_hat * each[rows], white[rows])
        shape = problem.target.shape
        residual, held = white.reshape(shape), held.reshape(shape)
        held_cost = np.sum(held**2, axis=1)
        established = self._projection.numbers(self._target - columns @ theta - white)
        size = self._base.size + len(theta)
        return Fit(
            members,
            np.concatenate([established, theta]),
            np.broadcast_to(np.nan, (size, size)),
            Prediction(residual * problem.sigma, residual, self._cost(white)),
            weights,
            score,
            problem.measured_part(held),
            held_cost,
            robust_sum(held_cost),
            np.ones(size, dtype=bool),
        )

    def gains(self, found: Fit[Any], candidates: Sequence[Any]) -> FloatArray:
        """By how much the score may fall when each candidate joins, to first order, shape (candidates,).

        Args:
            found: A fit of this.
            candidates: The same at every call.
        """
        if self._slopes is None:
            slopes = Slopes(self._problem, candidates)
            left = self._clear(self._projection.left(slopes.columns))
            self._slopes = (slopes, left, slopes.grams(left, left))
        slopes, left, grams = self._slopes
        # Trials set aside by the smaller model may be just those that a new term explains.
        weighted = self._weighted(
            trial_weights(self._cost(found.prediction.white), False, self._problem.components)
        )
        # Only the space of the terms matters, and of those that hardly differ the products would not know it.
        beside, _ = np.linalg.qr(self._clear(self._columns(found.members[1:])[1]))
        target = self._clear(self._left)
        moved = weighted.moved(left)
        inverse = np.linalg.inv(weighted.product(beside, beside, beside))
        cross = left.T @ beside - moved.T @ beside[weighted.rows]
        pull = left.T @ target - moved.T @ target[weighted.rows]
        pull = pull - cross @ (inverse @ weighted.product(beside, beside, target))
        changed = slopes.grams(left[weighted.rows], moved)
        shared = slopes.grams(cross.T, inverse @ cross.T)
        return slopes.best(pull, [a - b - c for a, b, c in zip(grams, changed, shared, strict=True)])[0]

    def _clear(self, left: FloatArray) -> FloatArray:
        """What the established columns leave, less the little that the weak pull keeps them from following.

        Nothing of a fit hangs on that, but all of what is told of a term that they could nearly replace.
        """
        return self._projection.left(left)


def _pull(terms: Sequence[Any]) -> FloatArray:
    """The weak pull of `core.fit` on the numbers of terms, shape (t,)."""
    return np.concatenate([np.zeros(0), *(RIDGE / term.scale**2 for term in terms)])
