"""Hundreds of coefficients at once: a ridge with learnt sizes on sums of normal equations."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby
from typing import Protocol

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.linalg.lapack import dpotrf, dpotri

from doormill_ros.arrays import FloatArray, IntArray

_LEANING = 0.1  #: of the variance, that is left of it when another cause is known
_LEAST = 1e-6  #: of a typical size squared, what is left of one that the data do not call for


@dataclass(eq=False)
class Block:
    """Normal equations of some rows of a series, in white units.

    Attributes:
        series: Index of the series.
        rows: Its rows, shape (n,).
        ids: Coefficients that act there, shape (k,).
        H, g, c: Sums of J^T J (k, k), J^T y (k,) and y^T y with y = residual + J x.
        count: Sum of the weights.
    """

    series: int
    rows: IntArray
    ids: IntArray
    H: FloatArray
    g: FloatArray
    c: float
    count: float


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
    # Blocks of a series have their coefficients in common: added in their own order, sorted in once.
    for _, parts in groupby(sorted(blocks, key=lambda block: block.series), key=lambda block: block.series):
        first, *others = parts
        own, pull = first.H.copy(), first.g.copy()
        for block in others:
            own += block.H
            pull += block.g
        H[np.ix_(first.ids, first.ids)] += own
        g[first.ids] += pull
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


def solve(H: FloatArray, g: FloatArray, variance: FloatArray) -> Solution:
    """Solve H x = g, shapes (m, m) and (m,), with known prior variances, shape (m,)."""
    scale = np.where(np.isfinite(variance), np.sqrt(variance), 1.0 / np.sqrt(np.maximum(np.diag(H), 1e-12)))
    prior = np.where(np.isfinite(variance), 1.0, 1e-10)
    A = np.asfortranarray(H * scale * scale[:, None])
    A[np.diag_indices_from(A)] += prior
    # Factor and inverse in place in the lower half: a third of the work of solving for the unit matrix.
    factor, _ = dpotrf(A, lower=1, overwrite_a=1)
    inverse, _ = dpotri(factor, lower=1, overwrite_c=1)
    lower = np.tril(inverse, -1)
    covariance = lower + lower.T
    covariance[np.diag_indices_from(covariance)] = np.diag(inverse)
    covariance *= scale
    covariance *= scale[:, None]
    return Solution(covariance @ g, covariance, variance)


def learn(
    H: FloatArray,
    g: FloatArray,
    sizes: Sizes,
    rounds: int = 8,
    start: FloatArray | None = None,
) -> Solution:
    """Solve H x = g and learn the typical size of every group (empirical Bayes, MacKay's update); shapes as `solve`."""
    m = len(sizes.typical)
    variance = np.full(len(g), np.inf)
    variance[:m] = sizes.typical**2 if start is None else start[:m]
    found = solve(H, g, variance)
    count = np.bincount(sizes.group, minlength=sizes.group.max() + 1 if m else 0)
    for _ in range(rounds if m else 0):
        spread = np.diag(found.covariance)[:m]
        moment = np.bincount(sizes.group, found.x[:m] ** 2 + spread, minlength=len(count)) / count
        variance = variance.copy()
        variance[:m] = np.clip(moment[sizes.group], _LEAST * sizes.typical**2, 4.0 * sizes.typical**2)
        found = solve(H, g, variance)
    return found


def without(solution: Solution, ids: IntArray) -> Solution:
    """The solution with some coefficients, shape (k,), held at zero: exact, by conditioning."""
    if not len(ids):
        return solution
    C = solution.covariance
    factor = cho_factor(C[np.ix_(ids, ids)] + 1e-30 * np.eye(len(ids)))
    gain = cho_solve(factor, C[ids])
    x = solution.x - solution.x[ids] @ gain
    covariance = C - C[:, ids] @ gain
    x[ids] = 0.0
    covariance[ids] = 0.0
    covariance[:, ids] = 0.0
    return Solution(x, covariance, solution.variance)


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
