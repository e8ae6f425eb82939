"""The figures of a series of runs made ready for fitting: what changes make of them."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from typing import Self

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.diagnosis.core.course import BEGINS, GROWS, OverTime, SizeCourse
from doormill_ros.diagnosis.core.diagnosis import Diagnosis
from doormill_ros.diagnosis.core.fitting.nuisance import Nuisance
from doormill_ros.diagnosis.core.fitting.problem import Examined, Prediction, make_folds
from doormill_ros.diagnosis.core.times import growing
from doormill_ros.diagnosis.core.words.wording import Unit
from doormill_ros.diagnosis.runs.causes import RowCase, RunEffect, effects_of
from doormill_ros.diagnosis.runs.channels import CAMERA, MARKS, Channel, channels_of
from doormill_ros.diagnosis.runs.limits import FEWEST, fewest
from doormill_ros.diagnosis.runs.scatter import scatters, strays
from doormill_ros.diagnosis.runs.ungauged_run import UngaugedRun

#: Lengths, angles and times together: each counts by how far it scatters from run to run.
UNIT = Unit("standard deviations of one run", "times the scatter from run to run", 2, 1.0, relative=True)


class RunChange(OverTime[RunEffect]):
    """An effect that begins with a run or grows over all of them."""


class RunProblem(Examined[RunChange]):
    """All figures of a series, one a row, each against the others of its channel.

    Attributes:
        doors: The runs, in their order.
        channels: What they tell.
        strays: Numbers of runs, and channels, in which a single run is far from those around it; they do not count.
        configuration: Number of the run of each row, shape (n,).
    """

    unit = UNIT
    components = 1
    noise_floor = 1.0

    def __init__(self, runs: Sequence[UngaugedRun]) -> None:
        """Weigh every channel by how far it scatters from run to run."""
        self.doors = [
            replace(run, time=time)
            for run, time in zip(runs, growing([run.time for run in runs]), strict=True)
        ]
        recipes = [run.recipe for run in runs]
        self.channels: list[Channel] = []
        self.strays: list[tuple[int, str]] = []
        for one in channels_of(runs, fewest(len(runs))):
            far = strays(one.values, recipes, one.least)
            self.strays += [(int(run), one.name) for run in np.flatnonzero(far)]
            self.channels.append(replace(one, values=np.where(far, np.nan, one.values)))
        told = [np.flatnonzero(np.isfinite(channel.values)) for channel in self.channels]
        none = [np.zeros(0, dtype=int)]
        self.configuration = np.concatenate(none + told)
        channel = np.repeat(np.arange(len(told)), [len(rows) for rows in told])
        values = np.concatenate(
            [np.zeros(0)] + [one.values[rows] for one, rows in zip(self.channels, told, strict=True)]
        )
        time = np.array([run.time for run in self.doors])[self.configuration]
        self._case = RowCase(self.channels, channel, time)
        self.folds = make_folds(self.configuration)
        self.steps: tuple[int, ...] = ()
        own, recipe, door = self._scatters()
        beyond = [one.beyond[rows] for one, rows in zip(self.channels, told, strict=True)]
        self._std = np.sqrt(own[channel] ** 2 + np.concatenate([np.zeros(0), *beyond]))
        self.nuisance = self._nuisance(recipe, door)
        self._white = self.nuisance.take((values / self._std)[:, None])

    def __len__(self) -> int:
        return len(self.configuration)

    @property
    def case(self) -> RowCase:
        """What the effects look at."""
        return self._case

    def _scatters(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Standard deviations by channel: of its own, of its recipes, and of what sensors of a door have in common."""
        recipes = [run.recipe for run in self.doors]
        found = np.array([scatters(one.values, recipes, one.least) for one in self.channels]).reshape(-1, 2)
        own, recipe, door = found[:, 0], found[:, 1], np.zeros(len(found))
        for axis in range(3):
            looking = [i for i, one in enumerate(self.channels) if one.axis == axis and one.source != MARKS]
            first = next((i for i in looking if self.channels[i].source == CAMERA), None)
            others = [i for i in looking if i != first]
            if first is None or not others:
                continue
            camera = self.channels[first]
            for number in others:
                other = self.channels[number]
                apart = scatters(camera.values - other.values, recipes, camera.least)[0] ** 2
                part = _share(camera.stated, other.stated)
                whole = own[number] ** 2
                own[number] = np.sqrt(max((1.0 - part) * apart, other.least**2))
                door[number] = np.sqrt(max(whole - own[number] ** 2, 0.0))
                if number == others[0]:
                    whole = own[first] ** 2
                    own[first] = np.sqrt(max(part * apart, camera.least**2))
                    door[first] = np.sqrt(max(whole - own[first] ** 2, 0.0))
            common = door[looking].max()
            door[looking] = common
        return own, recipe, door

    def _nuisance(self, recipe: FloatArray, door: FloatArray) -> Nuisance:
        """Of each channel a level and what goes with width or time; recipes; where each door stood."""
        channel, run, n = self._case.channel, self.configuration, len(self)
        free, known = [np.zeros((n, 0))], [np.zeros((n, 0))]
        names = np.unique([one.recipe for one in self.doors], return_inverse=True)[1].ravel()
        for number, one in enumerate(self.channels):
            rows = channel == number
            about = np.where(rows, one.about[run] - one.about[run[rows]].mean(), 0.0)
            free.append(np.column_stack([rows, about / max(np.abs(about).max(), 1e-9)]).astype(float))
            if recipe[number] > 0.0:
                each = rows[:, None] & (names[run][:, None] == np.arange(names.max() + 1))
                known.append(each * recipe[number])
        axes = np.array([one.axis for one in self.channels], dtype=int)
        for axis in range(3):
            rows = (axes[channel] == axis) & (door[channel] > 0.0)
            if rows.any():
                each = rows[:, None] & (run[:, None] == np.arange(len(self.doors)))
                known.append(each * door[channel][:, None])
        scale = 1.0 / self._std[:, None]
        return Nuisance(np.hstack(known) * scale, np.hstack(free) * scale)

    def effects(self) -> list[RunEffect]:
        """Everything that may change."""
        return effects_of(self.channels) if len(self.doors) >= FEWEST else []

    def changed_at(self, steps: tuple[int, ...]) -> Self:
        """The same runs, with the numbers of those from which on something may have changed."""
        other = copy(self)
        other.steps = steps
        return other

    def candidates(self) -> list[RunChange]:
        """Every effect, from each of the steps on, and growing."""
        over = self.doors[0].time, self.doors[-1].time
        courses = [
            SizeCourse(BEGINS, self.doors[step].time, *over, words=f"from {self.doors[step].name} on")
            for step in self.steps
        ]
        courses.append(SizeCourse(GROWS, over[0], *over, words="drifting"))
        return [RunChange(effect, course) for effect in self.effects() for course in courses]

    def columns(self, cause: RunChange) -> FloatArray:
        """Derivative by one change in standard deviations, shape (n, p)."""
        return self.nuisance.take(cause.derivative(self._case) / self._std[:, None])

    def predict(
        self, members: Sequence[RunChange], theta: FloatArray, derivative: bool = False
    ) -> Prediction:
        """Residuals, likelihood and derivatives of a model, as `Problem.predict`."""
        slopes = np.hstack([np.zeros((len(self), 0)), *(self.columns(member) for member in members)])
        white = self._white - (slopes @ theta)[:, None]
        return Prediction(white, white, np.sum(white**2, axis=1), slopes[:, None] if derivative else None)

    def slope(self, cause: RunChange, theta: FloatArray) -> FloatArray:
        """Whitened derivative by one change alone, shape (n, 1, p)."""
        return self.columns(cause)[:, None]

    def measured_part(self, white: FloatArray) -> FloatArray:
        """The same, shape (n, 1): residuals are told in standard deviations."""
        return white

    def bent(self) -> Self | None:
        """There is one model."""
        return None

    def cuts(self) -> dict[str, BoolArray]:
        """Every other run, shape (n,)."""
        return {"every other run": self.configuration % 2 == 0}

    def groupings(self) -> Sequence[IntArray]:
        """Channels, shape (n,): a run that went wrong may be wrong in all of them."""
        return (self._case.channel,)

    def turning(self, residual: FloatArray, gross: BoolArray) -> tuple[str, float]:
        """There are no joints here."""
        return "", 1.0

    def labels(self) -> IntArray:
        """Runs, counted from 1, shape (n,)."""
        return self.configuration + 1


def _share(one: float, other: float) -> float:
    """Of the variance of a difference that the first of two is to blame for, by what they state."""
    if not (np.isfinite(one) and np.isfinite(other) and one + other > 0.0):
        return 0.5
    return float(np.clip(one**2 / (one**2 + other**2), 0.1, 0.9))


#: What is known of a series of runs.
RunDiagnosis = Diagnosis[RunProblem, RunChange]
