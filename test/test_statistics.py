"""Robust statistics against NumPy, SciPy and known samples."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2, median_abs_deviation

from doormill_ros.statistics import (
    CHI_SQUARE_MEDIAN,
    NORMAL_STD,
    bootstrap_ratio,
    huber_weights,
    median,
    median_length,
    resampled,
    row_medians,
    share,
)


def test_medians_are_the_upper_ones() -> None:
    values = np.random.default_rng(0).normal(size=(41, 3))
    assert median(values) == np.median(values)
    assert row_medians(values.T).tolist() == np.median(values, axis=0).tolist()
    assert median(np.array([4.0, 1.0, 3.0, 2.0])) == 3.0
    assert share(np.array([[True, False], [True, True]])) == 0.75


def test_constants_of_the_normal_distribution() -> None:
    values = np.random.default_rng(0).normal(size=100_001)
    assert NORMAL_STD * median_abs_deviation(values) == pytest.approx(1.0, abs=0.01)
    assert NORMAL_STD**2 * CHI_SQUARE_MEDIAN[1] == pytest.approx(1.0, abs=1e-3)
    assert list(CHI_SQUARE_MEDIAN.values()) == pytest.approx(chi2.median(list(CHI_SQUARE_MEDIAN)), abs=5e-4)
    assert median_length(3) == pytest.approx(np.sqrt(chi2.median(3)), abs=1e-4)


def test_huber_weights_cap_the_pull() -> None:
    size = np.array([0.0, 1.0, 2.0, 4.0, 200.0])
    weights = huber_weights(size, 2.0)
    assert weights.tolist() == [1.0, 1.0, 1.0, 0.5, 0.01]
    assert (weights * size).max() == 2.0


def test_the_stream_of_resampled_rows_is_written_down() -> None:
    """Raw words of PCG64 are promised by NumPy; these rows must never change."""
    assert resampled(10, 2).tolist() == [[8, 6, 5, 2, 3, 0, 0, 0, 1, 8], [6, 9, 5, 6, 9, 7, 6, 5, 5, 9]]
    rows = resampled(7, 3000)
    assert rows.shape == (3000, 7)
    counts = np.bincount(rows.ravel(), minlength=7)
    assert np.abs(counts - 3000).max() < 5.0 * np.sqrt(3000)
    assert resampled(3, 1).shape == (1, 3)


def test_the_interval_covers_the_ratio_as_often_as_it_says() -> None:
    rng = np.random.default_rng(3)
    hits = 0
    for _ in range(200):
        before = rng.chisquare(30, 60)
        after = 0.25 * rng.chisquare(30, 60)
        ratio, (low, high) = bootstrap_ratio(before, after, draws=400)
        assert low <= ratio <= high
        hits += low <= 0.5 <= high
    assert 176 <= hits <= 200  # 95 % of 200, four standard deviations down


def test_groups_without_any_squares_tell_no_ratio() -> None:
    """Two runs of two doors agree with what is fitted to each, or nearly so: rounding decides what is zero."""
    ratio, (low, high) = bootstrap_ratio(np.array([0.0, 4.0]), np.array([0.0, 1.0]), draws=400)
    assert (ratio, low, high) == (0.5, 0.5, 0.5)
    assert bootstrap_ratio(np.zeros(2), np.zeros(2)) == (1.0, (1.0, 1.0))
