"""Probability distributions by the functions of scipy.special; scipy.stats takes a second to import.

Named as in scipy.stats and equal to it bit by bit: `sf` is the chance of more than a value, `isf` the value that has a
chance, `ppf` the quantile and `pdf` the density. Degrees of freedom are positive, chances lie between 0 and 1.
"""

from __future__ import annotations

import numpy as np
from scipy.special import chdtrc, chdtri, gammaincinv, ndtri, stdtrit


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
