"""Errors of gear or encoder that come back with every turn of motor or joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.view import SeenMotion

#: Orders of a slow error, waves a turn of the joint, and of the motor's.
JOINT_ORDERS, MOTOR_ORDERS = tuple(range(1, 13)), (1, 2, 3, 4, 6, 8)
#: Waves a turn of the joint from which an encoder without an index has another phase after every start.
FINE = 30.0
_LARGEST = 5e-3  #: rad
#: Times its standard deviation in the recording that shows most of it, at most; 1.4 for a whole wave
_SHOWN = 5.0


class MotionPeriodicError(MotionCause):
    """x are cosine and sine [rad] of one order; the search puts several orders of a joint side by side.

    Attributes:
        order: Waves a turn of the angle.
        angle: "joint" or "motor".
        free: Whether the phase belongs to the recording: a fine scale without an index counts from wherever it starts.
        smoothed: Whether the encoder's lag also lowers the wave: late by a filter, not by waiting.
    """

    name = "joint_periodic_error"

    def __init__(
        self, where: str, order: float, angle: str = "joint", free: bool = False, smoothed: bool = False
    ) -> None:
        """Put one order at its place."""
        super().__init__(where)
        self.order, self.angle, self.free, self.smoothed = order, angle, free, smoothed
        self.phased, self.variant = free, f"order {order:.6g} of the {angle}"

    @classmethod
    def candidates(cls, where: str, motions: Sequence[SeenMotion]) -> Sequence[MotionCause]:
        """The usual orders; the others are found in what is left over."""
        return [
            *(cls(where, float(order)) for order in JOINT_ORDERS),
            *(cls(where, float(order), "motor") for order in MOTOR_ORDERS),
        ]

    @property
    def settings(self) -> dict[str, Any]:
        """Order, angle, and how phase and height behave."""
        return {"order": self.order, "angle": self.angle, "free": self.free, "smoothed": self.smoothed}

    @classmethod
    def build(cls, where: str, settings: Mapping[str, Any]) -> Self:
        """With its order."""
        return cls(
            where,
            float(settings["order"]),
            str(settings["angle"]),
            bool(settings["free"]),
            bool(settings["smoothed"]),
        )

    @property
    def slot(self) -> tuple[str, ...]:
        """Every order is one of its own."""
        return (self.name, self.where, self.angle, f"{self.order:.6g}")

    @property
    def slow(self) -> bool:
        """Whether it is one of the slowest waves."""
        return self.angle == "joint" and self.order < FINE

    def waves(self, seen: SeenMotion) -> float:
        """Waves in a turn of the joint."""
        return self.order * (seen.motion.gear_ratio if self.angle == "motor" else 1.0)

    def wave(self, seen: SeenMotion) -> FloatArray:
        """Cosine and sine, shape (n, 2)."""
        waves = self.waves(seen)
        if not self.smoothed:
            turned = waves * seen.motor
            return np.column_stack([np.cos(turned), np.sin(turned)])
        # A lag of first order with the encoder's delay for its time, quasi-stationary: 1 / (1 + i w T).
        response = np.exp(1j * waves * seen.motion.motor) / (1.0 + 1j * waves * seen.speed * seen.delay)
        return np.column_stack([response.real, response.imag])

    def columns(self, seen: SeenMotion) -> FloatArray:
        """Cosine and sine, shape (n, 2); none when the phase is the recording's own."""
        return np.zeros((len(seen), 0)) if self.free else self.wave(seen)

    def own_columns(self, seen: SeenMotion) -> FloatArray:
        """Cosine and sine, shape (n, 2), when the phase is the recording's own."""
        return self.wave(seen) if self.free else np.zeros((len(seen), 0))

    def allowed(self, x: FloatArray, stiffness: float, motions: Sequence[SeenMotion]) -> bool:
        """A size that gears and encoders have, and that shows: less than half a wave may be part of another."""
        size = float(np.linalg.norm(x))
        if size > _LARGEST or self.free:
            return size < _LARGEST
        shown = max(float(np.std(self.wave(seen) @ x)) for seen in motions)
        low, high = (end([end(seen.motor) for seen in motions]) for end in (np.min, np.max))
        return size < _SHOWN * shown and self.waves(motions[0]) * float(high - low) > np.pi

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """Amplitude of the order."""
        return {f"{self.angle}_order_{self.order:.6g}": (float(np.linalg.norm(x)), "rad")}

    def pattern(self) -> str:
        """What it leaves."""
        return f"the difference of the encoders goes up and down {self.order:.4g} times a turn of the {self.angle}"
