"""What fixed columns leave of anything, found once for all rows alike and put right for the few that count less.

With Q R = [B; sqrt(ridge)] and the upper part A of Q, N = I - A A^T leaves what the columns B cannot follow. A row of
weight w counts like one of full weight whose value is moved by some delta, so that weights w on rows D, all others 1,
leave

    M = N - N_:D (N_DD + diag(w / (1 - w)))^-1 N_D:   in the place of   W - W B (B^T W B + ridge)^-1 B^T W,

the identity of Woodbury: what weights change costs the rows whose weight is not 1, whatever the number of columns.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import lu_factor, lu_solve, solve_triangular

from doormill_ros.arrays import FloatArray, IntArray


class Projection:
    """Fixed columns, every row at its full weight.

    Attributes:
        columns: B, shape (n, p).
        hat: A A^T: what the fit makes of a unit in every row, shape (n, n).
    """

    def __init__(self, columns: FloatArray, ridge: FloatArray) -> None:
        """Factor the columns once.

        Args:
            columns: Whitened, shape (n, p).
            ridge: Weak pull to zero of every number, shape (p,).
        """
        self.columns = columns
        whole, self._triangle = np.linalg.qr(np.vstack([columns, np.diag(np.sqrt(ridge))]))
        self._basis = np.ascontiguousarray(whole[: len(columns)])
        self.hat: FloatArray = self._basis @ self._basis.T

    def left(self, values: FloatArray) -> FloatArray:
        """N values, of shape (n,) or (n, k)."""
        result: FloatArray = values - self._basis @ (self._basis.T @ values)
        return result

    def numbers(self, followed: FloatArray) -> FloatArray:
        """Shape (p,), of what the columns make with them, shape (n,)."""
        theta = np.zeros(self.columns.shape[1])
        # The weak pull puts the first of them off by its share of the columns, the second by that squared.
        for _ in range(2):
            rest = followed - self.columns @ theta
            theta = theta + solve_triangular(self._triangle, self._basis.T @ rest)
        return theta


class Weighted:
    """The same with weights.

    Attributes:
        rows: D, those of a weight below 1, shape (d,).
    """

    def __init__(self, projection: Projection, weights: FloatArray) -> None:
        """Factor what the rows of a weight below 1 change.

        Args:
            projection: With all rows at their full weight.
            weights: At most 1, shape (n,).
        """
        self.rows: IntArray = np.flatnonzero(weights < 1.0)
        self._hat = projection.hat
        own = -self._hat[np.ix_(self.rows, self.rows)]
        own[np.diag_indices_from(own)] += 1.0 / (1.0 - weights[self.rows])
        self._factor = lu_factor(own) if len(own) else (own, self.rows)

    def moved(self, left: FloatArray) -> FloatArray:
        """By how much the values of D have to move, of what full weights leave: shape (n, ...) to (d, ...)."""
        own = left[self.rows]
        return np.asarray(lu_solve(self._factor, own)) if own.size else own

    def residual(self, left: FloatArray) -> FloatArray:
        """What a fit with the weights leaves, of what one with full weights leaves, shapes (n,) or (n, k)."""
        # The hat matrix is symmetric: its rows lie together.
        result: FloatArray = left + self._hat[self.rows].T @ self.moved(left)
        return result

    def product(self, one: FloatArray, left_one: FloatArray, left_other: FloatArray) -> FloatArray:
        """x^T M y of values x and of what full weights leave of x and y, shapes (n, k) and (n,) or (n, l)."""
        result: FloatArray = one.T @ left_other - left_one[self.rows].T @ self.moved(left_other)
        return result

    def hats(self, blocks: list[IntArray]) -> list[FloatArray]:
        """B (B^T W B + ridge)^-1 B^T within each of some blocks of rows, shape (k, k) each."""
        pulled = self._hat[self.rows]
        moved = lu_solve(self._factor, pulled) if pulled.size else pulled
        return [self._hat[np.ix_(own, own)] + pulled[:, own].T @ moved[:, own] for own in blocks]
