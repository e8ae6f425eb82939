"""One joint of a recording together with the others, which may drive what happens in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.view import JointMotion, SeenMotion, followed


@dataclass(frozen=True, eq=False)
class Ride:
    """A recording as terms of laws look at it.

    Attributes:
        own: The joint in question.
        others: All joints that were recorded, by their index 0 ... 5.
    """

    own: SeenMotion
    others: Mapping[int, SeenMotion] = field(default_factory=dict)

    def of(self, joint: int) -> SeenMotion | None:
        """A joint by its index; None where it was not recorded."""
        return self.own if joint == self.own.motion.joint - 1 else self.others.get(joint)

    def __len__(self) -> int:
        return len(self.own)

    @cached_property
    def spring(self) -> FloatArray:
        """Link minus motor angle by the spring of the model in question, shape (n,) [rad]."""
        return -self.own.torque / self.own.motion.stiffness

    def late_spring(self, settles: float) -> FloatArray:
        """The same as a body yields that follows its load with a time constant [s], shape (n,) [rad]."""
        return followed(self.own.time, self.spring, settles)


def ride_of(motion: JointMotion, company: Sequence[JointMotion], delay: float = 0.0) -> Ride:
    """A joint as a link encoder sees it that is late by a delay [s], with the joints that were recorded beside it."""
    return Ride(motion.seen(delay), {one.joint - 1: one.seen(delay) for one in company})
