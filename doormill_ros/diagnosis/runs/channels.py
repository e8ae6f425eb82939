"""Figures that every run of a series tells without a gauge, one channel each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.special import polygamma

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import OFFSETS
from doormill_ros.diagnosis.runs.ungauged_run import UngaugedRun

UNITS = ("m", "m", "rad")  #: of `OFFSETS`
#: Sources of channels beside the other sensors, which have their own names.
CAMERA, MARKS, RESIDUAL, SCATTER = "camera", "marks", "residual", "scatter"
MILLING, ANSWER, LINK, SPINDLE = "milling", "answer", "link", "spindle load"
REPEATS = 2  #: pictures of a door from which their scatter is told

#: Smallest scatter from run to run that is believed: of places [m, m, rad], and of logarithms.
_LEAST_PLACE = np.array([1e-6, 1e-6, 1e-6])
_LEAST_SHARE, _LEAST_OF_MILLING = 0.05, 2e-3
_LEAST_TIME = 1e-3  #: of a cycle, for its logarithm [s]
_OF_MEDIAN = np.pi / 2.0  #: variance of a median, in that of a mean


@dataclass(frozen=True, eq=False)
class Channel:
    """One figure over the runs of a series.

    Attributes:
        source: What tells it.
        axis: Which of `OFFSETS`; -1 for logarithms of a size or a time.
        values: Of every run, nan where it tells none, shape (r,) [m, rad or 1].
        stated: Standard deviation that its source states, median of all runs; nan where it states none.
        least: Smallest scatter from run to run that is believed.
        about: What beside chance may explain it, shape (r,): the door's width, or the time that was predicted.
        beyond: Variance beyond what is usual that repeats of this run show, shape (r,).
    """

    source: str
    axis: int
    values: FloatArray
    stated: float
    least: float
    about: FloatArray
    beyond: FloatArray

    @property
    def name(self) -> str:
        """As a chart has it."""
        return self.source if self.axis < 0 else f"{self.source}, {OFFSETS[self.axis]}"

    @property
    def unit(self) -> str:
        """Of the values."""
        return "" if self.axis < 0 else UNITS[self.axis]


def channels_of(runs: Sequence[UngaugedRun], fewest: int) -> list[Channel]:
    """Every channel that at least `fewest` runs tell."""
    width = np.array([run.width for run in runs])
    logarithm = np.log(np.array([max(run.cycle_time, _LEAST_TIME) for run in runs]))
    predicted = np.where(np.isfinite(logarithm), logarithm, 0.0)
    usual, none = _usual_scatter(runs), np.zeros((len(runs), len(OFFSETS)))
    found: list[Channel] = []

    def places(
        source: str, of: Callable[[UngaugedRun], FloatArray], stated: FloatArray, beyond: FloatArray = none
    ) -> None:
        values = np.array([of(run) for run in runs]).reshape(-1, 3)
        for axis in range(3):
            own = values[:, axis], float(stated[axis]), _LEAST_PLACE[axis]
            found.append(Channel(source, axis, *own, width, beyond[:, axis]))

    def logarithms(
        source: str, of: Callable[[UngaugedRun], float], about: FloatArray, least: float = _LEAST_SHARE
    ) -> None:
        sizes = np.array([of(run) for run in runs], dtype=float)
        with np.errstate(divide="ignore", invalid="ignore"):
            values = np.where(sizes > 0.0, np.log(sizes), np.nan)
        found.append(Channel(source, -1, values, float("nan"), least, about, none[:, 0]))

    stated = _median([one.std for run in runs for one in run.pictures])
    places(CAMERA, _pictured, stated, np.array([_beyond(run, usual) for run in runs]))
    for name in dict.fromkeys(name for run in runs for name in run.sensors):
        stated = _median([run.sensors[name].std for run in runs if name in run.sensors])
        places(name, partial(_sensed, name), stated)
    places(MARKS, lambda run: np.full(3, np.nan) if run.marks is None else run.marks, np.full(3, np.nan))
    logarithms(RESIDUAL, _residual, width)
    logarithms(SCATTER, lambda run: _scatter(run, usual), width, _scatter_of_scatter(runs))
    logarithms(
        MILLING, lambda run: run.milling / max(run.cycle_time, _LEAST_TIME), predicted, _LEAST_OF_MILLING
    )
    logarithms(ANSWER, lambda run: run.answer, predicted)
    logarithms(LINK, lambda run: run.link, predicted)
    logarithms(SPINDLE, lambda run: run.work, predicted)
    return [channel for channel in found if np.isfinite(channel.values).sum() >= fewest]


def _pictured(run: UngaugedRun) -> FloatArray:
    if not run.pictures:
        return np.full(3, np.nan)
    return np.asarray(np.median([one.offset for one in run.pictures], axis=0))


def _sensed(name: str, run: UngaugedRun) -> FloatArray:
    return run.sensors[name].offset if name in run.sensors else np.full(3, np.nan)


def _residual(run: UngaugedRun) -> float:
    return float(np.median(run.residuals)) if len(run.residuals) else float("nan")


def _spread(run: UngaugedRun) -> FloatArray:
    """Variance of repeated pictures, shape (3,); nan where there are none."""
    if len(run.pictures) < REPEATS:
        return np.full(3, np.nan)
    return np.asarray(np.var([one.offset for one in run.pictures], axis=0, ddof=1))


def _usual_scatter(runs: Sequence[UngaugedRun]) -> FloatArray:
    return _median([spread for run in runs if np.all(np.isfinite(spread := _spread(run)))])


def _beyond(run: UngaugedRun, usual: FloatArray) -> FloatArray:
    """Variance of the median of repeated pictures beyond what is usual, shape (3,)."""
    more = np.maximum(_spread(run) - usual, 0.0) * _OF_MEDIAN / max(len(run.pictures), 1)
    return np.where(np.isfinite(more), more, 0.0)


def _scatter(run: UngaugedRun, usual: FloatArray) -> float:
    """How repeated pictures of one door scatter, in what is usual in the series."""
    return float(np.sqrt(np.mean(_spread(run) / np.maximum(usual, 1e-30))))


def _scatter_of_scatter(runs: Sequence[UngaugedRun]) -> float:
    """Standard deviation of the logarithm of a scatter that pictures as few as these tell, by chance alone."""
    repeats = [len(run.pictures) for run in runs if len(run.pictures) >= REPEATS]
    freedom = len(OFFSETS) * (np.median(repeats) - 1.0) if repeats else 1.0
    return float(0.5 * np.sqrt(polygamma(1, freedom / 2.0)))


def _median(rows: Sequence[FloatArray]) -> FloatArray:
    return np.asarray(np.median(rows, axis=0)) if len(rows) else np.full(3, np.nan)
