"""Distributions against scipy.stats, bit by bit, over values and chances from everyday to far out."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2, norm, t

from doormill_ros.distributions import (
    chi2_isf,
    chi2_ppf,
    chi2_sf,
    normal_pdf,
    normal_ppf,
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
