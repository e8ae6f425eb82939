"""Distributions against scipy.stats, bit by bit, over values and chances from everyday to far out."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2, norm, t, wilcoxon

from doormill_ros.distributions import (
    chi2_isf,
    chi2_ppf,
    chi2_sf,
    normal_pdf,
    normal_ppf,
    signed_rank_sf,
    student_ppf,
)

FREEDOM = [1, 2, 3, 3.0, 5, 6.6, 17, 120.0, 999.5, 20_000]
VALUES = [0.0, *np.geomspace(1e-9, 1e6, 181).tolist()]
CHANCES = [0.2, 0.05, 0.975, *np.geomspace(1e-15, 0.5, 101), *(1.0 - np.geomspace(1e-9, 0.5, 61))]


@pytest.mark.parametrize("freedom", FREEDOM)
def test_those_with_degrees_of_freedom_are_those_of_scipy(freedom: float) -> None:
    assert [chi2_sf(value, freedom) for value in VALUES] == chi2.sf(VALUES, freedom).tolist()
    assert [chi2_isf(chance, freedom) for chance in CHANCES] == chi2.isf(CHANCES, freedom).tolist()
    assert [chi2_ppf(chance, freedom) for chance in CHANCES] == chi2.ppf(CHANCES, freedom).tolist()
    assert [student_ppf(chance, freedom) for chance in CHANCES] == t.ppf(CHANCES, freedom).tolist()


def test_the_normal_distribution_is_that_of_scipy() -> None:
    values = [*VALUES, *(-value for value in VALUES)]
    assert [normal_pdf(value) for value in values] == norm.pdf(values).tolist()
    assert [normal_ppf(chance) for chance in CHANCES] == norm.ppf(CHANCES).tolist()


def test_every_number_exceeds_what_is_below_zero() -> None:
    assert chi2_sf(-1.0, 3) == chi2.sf(-1.0, 3) == 1.0
    assert np.isnan(chi2_sf(np.nan, 3))


@pytest.mark.parametrize("digits", [12, 1])
@pytest.mark.parametrize("count", [1, 2, 3, 7, 13, 14, 40, 50, 51, 200])
def test_signed_ranks_are_those_of_scipy(count: int, digits: int) -> None:
    """Counted or by the normal distribution, with values of equal size (one digit) and without."""
    rng = np.random.default_rng(count)
    for shift in (-0.5, 0.0, 0.2, 1.0):
        values = np.round(rng.normal(shift, 1.0, count), digits)
        values[values == 0.0] = 0.1
        expected = float(wilcoxon(values, alternative="greater").pvalue)
        assert signed_rank_sf(values) == pytest.approx(expected, rel=1e-11, abs=1e-15)
