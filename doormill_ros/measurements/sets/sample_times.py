"""Times of a recording: whether its samples were taken evenly, however coarsely that was written down."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.errors import DataSetError
from doormill_ros.measurements.documents.trial_table import TrialTable
from doormill_ros.measurements.errors import MotionTableError

#: Shortest recording of use [samples].
SHORTEST = 200
#: Share of a sample's time by which a sample may be early or late, and of all samples that may be missing.
JITTER, MISSING = 0.1, 0.2
_DECIMALS = 9  #: of a time [s], at most
_ROUNDED = 0.6  #: of the last decimal that rounding takes a time away from a grid that is itself fitted
_EXACT = 1e-6  #: share of a sample's time that is no deviation


@dataclass(frozen=True)
class _Grid:
    """Even times nearest to those of a recording.

    Attributes:
        step: From sample to sample [s].
        place: Of each sample, in whole steps, shape (n,).
        time: Of these places, shape (n,) [s].
    """

    step: float
    place: FloatArray
    time: FloatArray


def even_times(table: TrialTable, time: FloatArray, rate: float) -> FloatArray:
    """Times of samples that lie on a grid of about the rate, of which a few may be missing.

    A recorder's clock differs a little from the nominal one: the grid is the one that fits the times.

    Args:
        table: Where they were read.
        time: As written, shape (n,) [s].
        rate: As stated [1 / s].

    Returns:
        Shape (n,) [s]: as written, or those of the grid where nothing but rounding lies between.

    Raises:
        MotionTableError: They are too few, do not ascend, are not even or not of that rate.
    """
    if len(time) < SHORTEST:
        raise _fail(table, len(time) - 1, f"ends after {len(time)} samples, allowed are {SHORTEST} or more")
    steps = np.diff(time)
    for index in np.flatnonzero(steps <= 0.0):
        raise _fail(
            table, int(index) + 1, f"{time[index + 1]:g} follows {time[index]:g}, times have to ascend"
        )
    decimal = _last_decimal(time)
    usual = _usual(steps, decimal)
    if abs(usual * rate - 1.0) > JITTER:
        raise _fail(
            table, 1, f"samples are {usual:g} s apart, a rate of {rate:g} needs {1.0 / rate:g}; correct rate"
        )
    grid = _grid(time, usual)
    off = np.abs(time - grid.time)
    rounded = _ROUNDED * decimal
    worst = int(np.argmax(off))
    if off[worst] > max(JITTER * grid.step, rounded):
        raise _fail(
            table,
            worst,
            f"{time[worst]:g} lies {off[worst]:.2g} s beside the grid of {grid.step:.6g} s that fits all times best, "
            f"allowed is {100 * JITTER:.0f} % of that; sample the recording evenly",
        )
    missing = 1.0 - len(time) / (grid.place[-1] - grid.place[0] + 1.0)
    if missing > MISSING:
        raise _fail(
            table,
            len(time) - 1,
            f"{100 * missing:.0f} % of the samples are missing, allowed are {100 * MISSING:.0f}",
        )
    return grid.time if _EXACT * grid.step < off[worst] <= rounded else time


def _last_decimal(time: FloatArray) -> float:
    """What the last decimal of times is worth that all of them have [s]."""
    for digits in range(_DECIMALS):
        if np.allclose(time, np.round(time, digits), rtol=0.0, atol=0.01 * 10.0**-_DECIMALS):
            return float(10.0**-digits)
    return float(10.0**-_DECIMALS)


def _usual(steps: FloatArray, decimal: float) -> float:
    """Usual step [s]; rounding makes one of several, where no sample is missing, of which it is the mean."""
    middle = float(np.sort(steps)[len(steps) // 2])
    alike = (np.abs(steps - middle) < 1.5 * decimal) & (steps < 1.6 * middle)
    return float(np.mean(steps[alike]))


def _grid(time: FloatArray, usual: float) -> _Grid:
    """Fit step and beginning to places, and find these by them, until they stay."""
    since = time - time[0]
    place = np.concatenate([[0.0], np.cumsum(np.maximum(np.round(np.diff(time) / usual), 1.0))])
    for _ in range(10):
        around = place - place.mean()
        step = float(around @ since / (around @ around))
        begin = float(since.mean() - step * place.mean())
        before, place = place, np.round((since - begin) / step)
        if np.array_equal(place, before):
            break
    return _Grid(step, place, time[0] + begin + step * place)


def _fail(table: TrialTable, index: int, problem: str) -> DataSetError:
    line = table.lines[index]
    return MotionTableError(
        f"{table.path}: line {line}, column t: {problem}", path=str(table.path), line=line, column="t"
    )
