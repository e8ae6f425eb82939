"""A damper beside the spring, or a torque read late: the link follows the torque of a little earlier, or later."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.view import SeenMotion, followed

#: Times between torque and twist whose shapes are tried [s], and how many times such a time the fitted one may be.
TIMES = (0.003, 0.006, 0.012, 0.024, 0.048)
_NEAR = 1.6
_ALIKE = 0.02  #: share by which two times have one shape


class _TorqueChange(MotionCause):
    """x is the time between torque and twist over the stiffness [s rad / (N m)]; it multiplies a rate.

    The rate has the shape of a time that is tried, and in the end of the one that is found. The torque of a sample is
    not in its own rate: its noise is in the twist that the spring predicts, and whatever quiets that would seem to act.

    Attributes:
        time: That time [s]; 0 for the rate at once.
    """

    times: tuple[float, ...] = TIMES

    def __init__(self, where: str, time: float = TIMES[0]) -> None:
        """Put it at its place with the shape of a time [s]."""
        super().__init__(where)
        self.time, self.variant = time, f"{time:g} s"

    @classmethod
    def candidates(cls, where: str, motions: Sequence[SeenMotion]) -> Sequence[MotionCause]:
        """One for each time."""
        return [cls(where, time) for time in cls.times]

    @property
    def settings(self) -> dict[str, Any]:
        """The time."""
        return {"time": self.time}

    @classmethod
    def build(cls, where: str, settings: Mapping[str, Any]) -> Self:
        """With its time."""
        return cls(where, float(settings["time"]))

    @property
    def slot(self) -> tuple[str, ...]:
        """One for both: they differ by their signs."""
        return ("torque change", self.where)

    def allowed(self, x: FloatArray, stiffness: float, motions: Sequence[SeenMotion]) -> bool:
        """About the time whose shape it has, or less than the longest."""
        time = float(x[0]) * stiffness
        return self.time / _NEAR < time < (self.time or TIMES[-1]) * _NEAR

    def nearer(self, x: FloatArray, stiffness: float) -> Self:
        """With the shape of the time that was found."""
        time = float(x[0]) * stiffness
        if not self.time or not self.allowed(x, stiffness, ()) or abs(time - self.time) < _ALIKE * self.time:
            return self
        return type(self)(self.where, float(f"{time:.4g}"))


class SpringDamping(_TorqueChange):
    """Grease or rubber between the two sides of a gear, beside its spring: the twist comes after the torque."""

    name = "spring_damping"

    def columns(self, seen: SeenMotion) -> FloatArray:
        """How far what follows the torque is behind it, by the time, shape (n, 1)."""
        felt = seen.torque_beside()
        behind = felt - followed(seen.time, felt, self.time)
        return np.asarray(behind[:, None] / self.time, dtype=float)

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """Torque by rate of the twist."""
        return {"damping": (float(x[0]) * stiffness**2, "N m s / rad")}

    def pattern(self) -> str:
        """What it leaves."""
        return "the spring is wound less while the torque grows and more while it falls, at the same torque"


class TorqueSkew(_TorqueChange):
    """A torque that a drive sends later than the encoders are read, or filters: then its rate at once is missing."""

    name = "torque_skew"
    of_robot = False
    times = (0.0, *TIMES)

    def columns(self, seen: SeenMotion) -> FloatArray:
        """By how much the torque falls within the time, by that time, shape (n, 1)."""
        if not self.time:
            return -seen.torque_rate[:, None]
        return (seen.torque_beside() - seen.torque_beside(self.time))[:, None] / self.time

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """Skew, positive when the torque is late."""
        return {"skew": (float(x[0]) * stiffness, "s")}

    def pattern(self) -> str:
        """What it leaves."""
        return "the spring is wound more while the torque grows and less while it falls, at the same torque"
