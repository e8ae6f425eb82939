"""What may change in a cell and show in the bags of its runs, and in which channels each of it shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import OFFSETS
from doormill_ros.diagnosis.core.course import SizedEffect
from doormill_ros.diagnosis.runs.channels import (
    ANSWER,
    CAMERA,
    LINK,
    MARKS,
    MILLING,
    RESIDUAL,
    SCATTER,
    SPINDLE,
    UNITS,
    Channel,
)
from doormill_ros.robot_model.candidate import CauseParameter

_TYPICAL = 3e-4  #: size of a shift [m, rad]
_SHARE = 0.3  #: size of a logarithm
_LIKELY = 0.1  #: largest shift [m, rad]
_LARGEST = 10.0  #: logarithm
_FAR = 1e3
TURN = OFFSETS.index("rotation")


@dataclass(frozen=True, eq=False)
class RowCase:
    """What the effects look at.

    Attributes:
        channels: All of them.
        channel: Number of the channel of each row, shape (n,).
        time: Of the run of each row, shape (n,) [s since the epoch].
    """

    channels: Sequence[Channel]
    channel: np.ndarray
    time: FloatArray


class RunEffect(SizedEffect[RowCase]):
    """One way in which the figures of runs change, in proportion to theta."""

    of_robot = False

    def __init__(
        self, name: str, where: str, sentence: str, moves: Sequence[Shifted], variant: str = ""
    ) -> None:
        """Keep what it does.

        Args:
            name: Of the cause.
            where: Its place.
            sentence: What it leaves.
            moves: One a parameter.
            variant: See `Cause`.
        """
        super().__init__(where)
        self.name, self.variant, self._sentence, self._moves = name, variant, sentence, moves
        self.parameters = tuple(move.parameter for move in moves)
        self.scale = np.concatenate([np.full(move.size, move.typical) for move in moves])
        self.lower, self.upper = np.full(self.size, -_FAR), np.full(self.size, _FAR)

    def pattern(self) -> str:
        """What it leaves."""
        return self._sentence

    def columns(self, case: RowCase) -> FloatArray:
        """See the base class; shape (n, p) [m, rad or 1]."""
        return np.hstack([move.columns(case.channels)[case.channel] for move in self._moves])

    def values(self, theta: FloatArray, case: RowCase) -> FloatArray:
        """Shifts as they are, logarithms as factors."""
        shift = np.concatenate([np.full(move.size, bool(move.axes)) for move in self._moves])
        return np.where(shift, theta, np.exp(np.clip(theta, -_LARGEST, _LARGEST)))


@dataclass(frozen=True)
class Shifted:
    """What one parameter of an effect does to channels.

    Attributes:
        parameter: What is reported.
        sources: Of the channels; all are moved alike.
        axes: Numbers of the axes that it moves along; none for logarithms.
        against: Of the channels that it moves as far the other way about `TURN`, if that is among the axes.
    """

    parameter: CauseParameter
    sources: Sequence[str]
    axes: Sequence[int] = ()
    against: Sequence[str] = ()

    @property
    def size(self) -> int:
        """How many numbers it has."""
        return max(len(self.axes), 1)

    @property
    def typical(self) -> float:
        """Of one number [m, rad or 1]."""
        return _TYPICAL if self.axes else _SHARE

    def columns(self, channels: Sequence[Channel]) -> FloatArray:
        """How far each channel moves with each number, shape (channels, size)."""
        found = np.zeros((len(channels), self.size))
        for number, channel in enumerate(channels):
            if channel.source in self.sources:
                if not self.axes:
                    found[number, 0] = 1.0
                elif channel.axis in self.axes:
                    found[number, self.axes.index(channel.axis)] = 1.0
            elif channel.source in self.against and channel.axis == TURN and TURN in self.axes:
                found[number, self.axes.index(TURN)] = -1.0
        return found


def effects_of(channels: Sequence[Channel]) -> list[RunEffect]:
    """Everything that these channels can show; the likeliest of those that look alike first."""
    there = list(dict.fromkeys(channel.source for channel in channels))
    others = [name for name in there if name not in _OWN]
    found: list[RunEffect] = []
    for axes in _AXES:
        variant = "" if len(axes) == len(OFFSETS) else f"along {OFFSETS[axes[0]]}"
        offset = _parameter("offset", axes)
        # A camera that turned about x turns all doors the other way. Along y and z a turn about the other axes moves
        # doors too, by how far they are from the camera, so that marks say by themselves how far it moved.
        free = tuple(axis for axis in axes if CAMERA not in there or axis != TURN)
        seen = [Shifted(offset, [CAMERA], axes, against=[MARKS])] if CAMERA in there else []
        if MARKS in there and free:
            seen.append(Shifted(_parameter("moved", free), [MARKS], free))
        if seen:
            sentence = "the camera finds doors elsewhere, and no other sensor does"
            found.append(RunEffect("camera_shift", "camera", sentence, seen, variant))
        if CAMERA in there or others:
            sentence, moves = (
                "everything that looks at doors finds them elsewhere",
                [Shifted(offset, [CAMERA, *others], axes)],
            )
            found.append(RunEffect("clamp_shift", "clamp", sentence, moves, variant))
        sentence = "one sensor alone finds doors elsewhere"
        found += [
            RunEffect("sensor_shift", name, sentence, [Shifted(offset, [name], axes)], variant)
            for name in others
        ]
    factor = CauseParameter("factor", "1", 0.0, 1e3)
    found += [
        RunEffect(name, where, sentence, [Shifted(factor, [source])])
        for source, name, where, sentence in _OF_SIZES
        if source in there
    ]
    return found


def _parameter(name: str, axes: Sequence[int]) -> CauseParameter:
    if len(axes) > 1:
        return CauseParameter(name, ", ".join(UNITS[axis] for axis in axes), -_LIKELY, _LIKELY, len(axes))
    return CauseParameter(f"{name}_{OFFSETS[axes[0]]}", UNITS[axes[0]], -_LIKELY, _LIKELY)


#: What moves, moves along one axis or along all.
_AXES = ((0,), (1,), (2,), (0, 1, 2))
_OF_SIZES = (
    (RESIDUAL, "camera_lens", "camera", "edges of doors lie further from straight lines, or nearer"),
    (SCATTER, "camera_scatter", "camera", "repeated pictures of one door say other things of it"),
    (MILLING, "controller_speed", "controller", "programs take another share of the time that was predicted"),
    (ANSWER, "controller_answer", "controller", "the controller takes a ready signal after another time"),
    (LINK, "link_delay", "link", "writing targets and raising the signal take another time"),
    (SPINDLE, "cutting_power", "spindle", "the same doors take another share of the spindle's power"),
)
_OWN = (CAMERA, MARKS, *(source for source, *_ in _OF_SIZES))
