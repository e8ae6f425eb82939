"""Find the part of a recording in which nothing moves, and its mean.

The thesis logs ten seconds before and ten seconds after loading, once the system "had reached steady state"
(chapter 4), and averages every sample up to 40 s (A.8 to A.13). A rope that still swings or a weight put on
during the recording would go into that mean; here the recording is cut into blocks and the longest run of
blocks is taken whose means agree to within their own scatter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.measurements.errors import NotSteadyError
from doormill_ros.measurements.raw.raw_files import Recording
from doormill_ros.statistics import NORMAL_STD

_BLOCKS = 40
_SMALLEST_BLOCK = 4
#: Block means may lie this many standard deviations from the middle of the window.
_FACTOR = 4.5
#: Shortest window that counts [s].
SHORTEST = 2.0


@dataclass(frozen=True, eq=False)
class SteadyWindow:
    """Mean of a recording where it is steady.

    Attributes:
        start: First sample of the window.
        stop: Sample behind its last.
        duration: Length of the window [s].
        mean: Mean of each column.
        standard_error: Standard deviation of that mean, from the scatter of block means, so that noise which
            lasts for several samples does not count as many independent readings.
    """

    start: int
    stop: int
    duration: float
    mean: FloatArray
    standard_error: FloatArray


def steady_window(recording: Recording, shortest: float = SHORTEST) -> SteadyWindow:
    """The longest steady window of a recording; the later one of two equally long.

    Args:
        recording: Tracker or force samples.
        shortest: Length below which a window does not count [s].

    Raises:
        NotSteadyError: No window is that long.
    """
    time, values = recording.time, recording.values
    n = len(time)
    size = max(_SMALLEST_BLOCK, n // _BLOCKS)
    blocks = n // size
    if blocks < 3:
        raise NotSteadyError(
            f"{recording.path}: {n} samples are too few to tell whether they are steady, "
            f"at least {3 * _SMALLEST_BLOCK} are needed"
        )
    means = values[: blocks * size].reshape(blocks, size, -1).mean(axis=1)  # (blocks, columns)
    scatter = _block_scatter(values, means, size)
    first, last = _longest_run(means, scatter)
    start, stop = first * size, n if last == blocks else last * size
    duration = float(time[stop - 1] - time[start])
    if duration < shortest:
        raise NotSteadyError(
            f"{recording.path}: the longest steady window lasts {duration:.2f} s, at least {shortest:g} s "
            "are needed; record longer after loading, or keep the load from swinging"
        )
    inside = means[first:last]
    error = inside.std(axis=0, ddof=1) / np.sqrt(last - first)
    return SteadyWindow(
        start,
        stop,
        duration,
        values[start:stop].mean(axis=0),
        np.maximum(error, scatter / np.sqrt(last - first)),
    )


def _block_scatter(values: FloatArray, means: FloatArray, size: int) -> FloatArray:
    """Standard deviation of one block mean, shape (columns,).

    From differences of neighbouring blocks about their median: a ramp shifts every difference alike
    and must not look like scatter. Never less than what sample noise and the last printed digit allow.
    """
    step = np.diff(means, axis=0)
    between = NORMAL_STD * np.median(np.abs(step - np.median(step, axis=0)), axis=0) / np.sqrt(2.0)
    jump = np.diff(values, axis=0)
    white = NORMAL_STD * np.median(np.abs(jump - np.median(jump, axis=0)), axis=0) / np.sqrt(2.0 * size)
    rounding = np.spacing(np.abs(values).max(axis=0)) + 1e-12
    scatter: FloatArray = np.maximum(np.maximum(between, white), rounding)
    return scatter


def _longest_run(means: FloatArray, scatter: FloatArray) -> tuple[int, int]:
    """First block and the block behind the last of the longest run without outlier and without drift."""
    blocks = len(means)
    scaled = means / scatter
    for length in range(blocks, 1, -1):
        for first in range(blocks - length, -1, -1):
            run = scaled[first : first + length]
            if np.abs(run - np.median(run, axis=0)).max() > _FACTOR:
                continue
            # A least-squares line through independent block means ends +- sqrt(3 / length) from its middle
            # by chance alone.
            position = np.arange(length) - (length - 1) / 2.0
            slope = position @ run / (position @ position)
            if np.abs(slope).max() * (length - 1) / 2.0 <= _FACTOR * np.sqrt(3.0 / length):
                return first, first + length
    return 0, 1
