"""Springs and weight together as one model of a robot."""

from __future__ import annotations

from typing import Protocol

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.elastic.compliance import ComplianceModel, StandingSpread, remembers


class Sag(Protocol):
    """What moves a tool without load, as `GravitySag` tells it."""

    def twist(self, q: FloatArray, point: FloatArray) -> FloatArray:
        """Of the tool; shapes (n, 6) [rad], (3,) [m] -> (n, 6) [m, rad]."""
        ...

    def spread(self, q: FloatArray, point: FloatArray, relative: FloatArray) -> StandingSpread:
        """How well it is known; shapes (n, 6) [rad], (3,) [m], (6,)."""
        ...


class SaggingModel:
    """A robot that gives way under the process and sags under weight (implements StandingModel).

    The sag is what weight does to the springs; that it decides with the process against which flank of its gap a joint
    lies is for the model of the springs to know.

    Attributes:
        springs: How the robot gives way under loads.
        sag: What weight does to it.
    """

    def __init__(self, springs: ComplianceModel, sag: Sag) -> None:
        """Keep both."""
        self.springs = springs
        self.sag = sag

    @property
    def remembers(self) -> bool:
        """As `compliance.remembers` of the springs: weight acts the same from wherever a joint came."""
        return remembers(self.springs)

    def deflection(
        self, q: FloatArray, wrench: FloatArray, load_point: FloatArray, direction: FloatArray | None = None
    ) -> FloatArray:
        """Twist of the loaded tool against the taught places, as `ComplianceModel.deflection`."""
        return self.standing(q, load_point) + self.springs.deflection(q, wrench, load_point, direction)

    def standing(
        self, q: FloatArray, load_point: FloatArray, direction: FloatArray | None = None
    ) -> FloatArray:
        """The sag, as `StandingModel.standing`."""
        del direction
        return self.sag.twist(q, load_point)

    def standing_spread(self, q: FloatArray, load_point: FloatArray, relative: FloatArray) -> StandingSpread:
        """By springs, masses and balances, as `StandingModel.standing_spread`."""
        return self.sag.spread(q, load_point, relative)
