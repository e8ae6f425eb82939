"""Probability distributions by the functions of scipy.special; scipy.stats takes a second to import.

Named as in scipy.stats and equal to it bit by bit: `sf` is the chance of more than a value, `isf` the value that has a
chance, `ppf` the quantile and `pdf` the density. Degrees of freedom are positive, chances lie between 0 and 1.
"""

from __future__ import annotations

import numpy as np
from scipy.special import chdtrc, chdtri, gammaincinv, ndtr, ndtri, stdtrit

from doormill_ros.arrays import FloatArray

#: Values up to which all signs are counted, different ones and equal ones; the normal distribution stands for more.
_COUNTED, _COUNTED_TIED = 50, 13


def chi2_sf(value: float, freedom: float) -> float:
    """Chance of more than a value by the chi-square distribution."""
    return float(chdtrc(freedom, max(value, 0.0)))


def chi2_isf(chance: float, freedom: float) -> float:
    """Value of the chi-square distribution that is exceeded with a chance."""
    return float(chdtri(freedom, chance))


def chi2_ppf(chance: float, freedom: float) -> float:
    """Value of the chi-square distribution that is not exceeded with a chance."""
    return float(2.0 * gammaincinv(freedom / 2.0, chance))


def normal_pdf(value: float) -> float:
    """Density of the standard normal distribution."""
    return float(np.exp(-(value * value) / 2.0) / np.sqrt(2.0 * np.pi))


def normal_ppf(chance: float) -> float:
    """Value of the standard normal distribution that is not exceeded with a chance."""
    return float(ndtri(chance))


def student_ppf(chance: float, freedom: float) -> float:
    """Value of Student's t distribution that is not exceeded with a chance."""
    return float(stdtrit(freedom, chance))


def signed_rank_sf(values: FloatArray) -> float:
    """Chance that values as likely above as below zero lie above it as much as these, by Wilcoxon's signed ranks.

    Equal sizes share their ranks. What scipy.stats.wilcoxon says with alternative="greater", apart from rounding.

    Args:
        values: None of them zero, at least one, shape (n,).
    """
    n = len(values)
    _, place, tied = np.unique(np.abs(values), return_inverse=True, return_counts=True)
    twice = (2 * np.cumsum(tied) - tied + 1)[place]  # the ranks, doubled: shared ones are halves
    above = int(twice[values > 0.0].sum())
    if n > (_COUNTED_TIED if len(tied) < n else _COUNTED):
        variance = (n * (n + 1) * (2 * n + 1) - np.sum(tied.astype(float) ** 3 - tied) / 2.0) / 24.0
        return float(ndtr((n * (n + 1) / 2.0 - above) / 2.0 / np.sqrt(variance)))
    ways = np.zeros(n * (n + 1) + 1)  # by the doubled sum of the ranks above zero
    ways[0] = 1.0
    for rank in twice:
        ways[rank:] += ways[:-rank].copy()
    return float(ways[above:].sum() / 2.0**n)
