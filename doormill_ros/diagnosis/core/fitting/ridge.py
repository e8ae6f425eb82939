"""Hundreds of coefficients at once: a ridge with learnt sizes on sums of normal equations."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.linalg import cho_factor, cho_solve, cholesky
from scipy.linalg.lapack import dlauum, dtrtri

from doormill_ros.arrays import FloatArray, IntArray

_LEANING = 0.1  #: of the variance, that is left of it when another cause is known
_LEAST = 1e-6  #: of a typical size squared, what is left of one that the data do not call for


@dataclass(eq=False)
class Block:
    """Normal equations of some rows of a series, in white units.

    Attributes:
        series: Index of the series.
        rows: Its rows, shape (n,).
        ids: Coefficients that act there, ascending, shape (k,).
        H, g: Sums of J^T J (k, k) and J^T y (k,) with y = residual + J x.
    """

    series: int
    rows: IntArray
    ids: IntArray
    H: FloatArray
    g: FloatArray


class Sizes(Protocol):
    """How large coefficients may be, which come first among all that are solved for.

    Attributes:
        group: Group of every coefficient, shape (m,); those of a group share a size that is learnt from the data.
        typical: Largest plausible size, shape (m,).
    """

    @property
    def group(self) -> IntArray:
        """Shape (m,)."""

    @property
    def typical(self) -> FloatArray:
        """Shape (m,)."""


def add_up(blocks: Iterable[Block], size: int) -> tuple[FloatArray, FloatArray]:
    """Sum of the normal equations, shapes (m, m) and (m,)."""
    H, g = np.zeros((size, size)), np.zeros(size)
    for block in blocks:
        # Nearly all neighbours stand together: they are added run by run.
        runs = np.split(np.arange(len(block.ids)), np.flatnonzero(np.diff(block.ids) != 1) + 1)
        spans = [
            (slice(run[0], run[-1] + 1), slice(block.ids[run[0]], block.ids[run[-1]] + 1)) for run in runs
        ]
        for rows, here in spans:
            for columns, there in spans:
                H[here, there] += block.H[rows, columns]
        g[block.ids] += block.g
    return H, g


@dataclass(frozen=True, eq=False)
class Solution:
    """Coefficients, their covariance, and the variance each was expected to have.

    Attributes:
        x: Shape (m,).
        covariance: Shape (m, m).
        variance: Prior variance, infinite for placements, shape (m,).
    """

    x: FloatArray
    covariance: FloatArray
    variance: FloatArray


class _Factor:
    """Cholesky factor of the normal equations with known prior variances, inverted; all in units of their sizes."""

    def __init__(self, H: FloatArray, g: FloatArray, variance: FloatArray) -> None:
        """Of H x = g, shapes (m, m) and (m,), with prior variances, shape (m,)."""
        known = np.isfinite(variance)
        scale = np.where(known, np.sqrt(variance), 1.0 / np.sqrt(np.maximum(np.diag(H), 1e-12)))
        A = H * scale
        A *= scale[:, None]
        A[np.diag_indices_from(A)] += np.where(known, 1.0, 1e-10)
        # Seen by columns, as LAPACK wants it, a symmetric matrix is the same.
        factor = cholesky(A.T, lower=True, overwrite_a=True, check_finite=False)
        self._root, _ = dtrtri(factor, lower=1, overwrite_c=1)
        self._root *= scale
        self.x: FloatArray = (self._root @ g) @ self._root

    @property
    def spread(self) -> FloatArray:
        """Variance of every coefficient, shape (m,)."""
        result: FloatArray = np.einsum("ij,ij->j", self._root, self._root)
        return result

    def covariance(self) -> FloatArray:
        """Of all coefficients, shape (m, m); the factor is lost."""
        half, _ = dlauum(self._root, lower=1, overwrite_c=1)
        whole: FloatArray = half + half.T
        whole[np.diag_indices_from(whole)] *= 0.5
        return whole


def solve(H: FloatArray, g: FloatArray, variance: FloatArray) -> Solution:
    """Solve H x = g, shapes (m, m) and (m,), with known prior variances, shape (m,)."""
    factor = _Factor(H, g, variance)
    return Solution(factor.x, factor.covariance(), variance)


def learn(
    H: FloatArray,
    g: FloatArray,
    sizes: Sizes,
    rounds: int = 8,
    start: FloatArray | None = None,
) -> Solution:
    """Solve H x = g and learn the typical size of every group, by expectation and maximization; shapes as `solve`."""
    m = len(sizes.typical)
    variance = np.full(len(g), np.inf)
    variance[:m] = sizes.typical**2 if start is None else start[:m]
    count = np.bincount(sizes.group, minlength=sizes.group.max() + 1 if m else 0)
    for _ in range(rounds if m else 0):
        factor = _Factor(H, g, variance)
        square = factor.x[:m] ** 2 + factor.spread[:m]
        moment = np.bincount(sizes.group, square, minlength=len(count)) / count
        variance = variance.copy()
        variance[:m] = np.clip(moment[sizes.group], _LEAST * sizes.typical**2, 4.0 * sizes.typical**2)
    return solve(H, g, variance)


def held(solution: Solution, ids: IntArray) -> FloatArray:
    """The coefficients, shape (m,), with some of them, shape (k,), held at zero: exact, by conditioning."""
    if not len(ids):
        return solution.x
    own = solution.covariance[ids]
    x: FloatArray = solution.x - cho_solve(_factor_of(own[:, ids]), solution.x[ids]) @ own
    x[ids] = 0.0
    return x


def without(solution: Solution, ids: IntArray) -> Solution:
    """The solution with some coefficients, shape (k,), held at zero."""
    if not len(ids):
        return solution
    own = solution.covariance[ids]
    covariance = solution.covariance - own.T @ cho_solve(_factor_of(own[:, ids]), own)
    covariance[ids] = 0.0
    covariance[:, ids] = 0.0
    return Solution(held(solution, ids), covariance, solution.variance)


def _factor_of(covariance: FloatArray) -> tuple[FloatArray, bool]:
    """Cholesky factor, shape (k, k); coefficients that are held at zero already do not stop it."""
    factor: tuple[FloatArray, bool] = cho_factor(covariance + 1e-30 * np.eye(len(covariance)))
    return factor


def leans(x: FloatArray, covariance: FloatArray, own: slice, other: slice) -> bool:
    """Whether some coefficients would be known far better if others were: their effects overlap.

    Args:
        x: Coefficients, shape (m,).
        covariance: Of them, shape (m, m) or larger.
        own: Those that may lean.
        other: Those they may lean on.
    """
    C, size = covariance, x[own]
    cross = C[own, other]
    known = C[own, own] - cross @ np.linalg.lstsq(C[other, other], cross.T, rcond=1e-12)[0]
    now, then = float(size @ C[own, own] @ size), float(size @ known @ size)
    return now > 0.0 and then < _LEANING * now
