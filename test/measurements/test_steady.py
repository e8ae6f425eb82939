"""The steady window: transients are left out, ramps are refused, the standard error is honest."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doormill_ros.measurements.errors import NotSteadyError
from doormill_ros.measurements.raw.raw_files import Recording
from doormill_ros.measurements.raw.steady import steady_window

RATE = 100.0


def recording(signal: np.ndarray) -> Recording:
    signal = np.atleast_2d(signal.T).T
    return Recording(Path("x.txt"), np.arange(len(signal)) / RATE, signal)


def noise(n: int, columns: int, std: float, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(scale=std, size=(n, columns))


def test_a_quiet_recording_is_used_whole():
    values = np.array([1.0, 2.0, 3.0]) + noise(1000, 3, 1e-5, 1)
    window = steady_window(recording(values))
    assert (window.start, window.stop) == (0, 1000)
    assert np.array_equal(window.mean, values.mean(axis=0))


def test_a_step_during_the_recording_is_left_out():
    """The weight goes on after 3 s: only one side of the step may be averaged."""
    values = noise(1000, 1, 1e-5, 2)
    values[300:] += 1e-4
    window = steady_window(recording(values))
    assert window.start >= 300
    assert window.start <= 350
    assert window.mean[0] == pytest.approx(1e-4, abs=5 * 1e-5 / np.sqrt(650))


def test_a_swinging_load_is_waited_for():
    """A decaying swing biases the mean over all samples by more than the window's."""
    t = np.arange(2000) / RATE
    swing = 3e-4 * np.exp(-t / 1.5)
    values = swing[:, None] + noise(2000, 1, 1e-5, 3)
    window = steady_window(recording(values))
    assert abs(values.mean()) > 2e-5
    assert abs(window.mean[0]) < 3e-6
    assert window.duration > 10


@pytest.mark.parametrize("n", [1000, 4000])
@pytest.mark.parametrize("seed", range(5))
def test_a_drift_is_not_steady(seed, n):
    """A standard deviation every tenth of a second: no two seconds of it stand still."""
    values = np.linspace(0, 1e-6 * n, n)[:, None] + noise(n, 1, 1e-5, seed)
    with pytest.raises(NotSteadyError, match=r"x\.txt.*2 s"):
        steady_window(recording(values))


def test_too_few_samples():
    with pytest.raises(NotSteadyError, match="too few"):
        steady_window(recording(np.zeros((8, 3))))


@pytest.mark.parametrize("correlation", [0.0, 0.9])
def test_standard_error_covers_the_mean_also_for_coloured_noise(correlation):
    """Errors over standard errors of 200 recordings have about unit variance, also with slow noise."""
    rng = np.random.default_rng(7)
    ratios, lengths = [], []
    for _ in range(200):
        white = rng.normal(size=2000)
        values = np.empty(2000)
        values[0] = white[0]
        for i in range(1, 2000):
            values[i] = correlation * values[i - 1] + np.sqrt(1 - correlation**2) * white[i]
        window = steady_window(recording(values))
        lengths.append(window.stop - window.start)
        ratios.append(window.mean[0] / window.standard_error[0])
    assert np.mean(lengths) > 1900
    # 5 sigma of a mean square over 200 is 0.5; the estimate itself scatters and errs to the safe side.
    assert 0.5 < np.mean(np.square(ratios)) < 1.5


def test_constant_files_do_not_divide_by_zero():
    window = steady_window(recording(np.full((500, 3), 1.25)))
    assert window.mean.tolist() == [1.25] * 3
    assert np.all(np.isfinite(window.standard_error))
