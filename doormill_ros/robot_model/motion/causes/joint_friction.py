"""Friction between motor and spring: torque that the spring does not see."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.causes.cause import FRICTION, MotionCause, largest_torque
from doormill_ros.robot_model.motion.view import SeenMotion

#: Ways that bristles bend before they slide [rad of the joint].
WIDTHS = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2)


class MotionFriction(MotionCause):
    """x is the friction over the stiffness [rad]; bristles bend before they slide, and remember where they turned.

    How far they were bent before the recording began is the recording's own.
    """

    name = "joint_friction"
    acts_on = FRICTION
    told_settings = ("width",)

    def __init__(self, where: str, width: float = WIDTHS[0]) -> None:
        """Put it at its place with bristles that bend by a width [rad]."""
        super().__init__(where)
        self.width = width

    @classmethod
    def candidates(cls, where: str, motions: Sequence[SeenMotion]) -> Sequence[MotionCause]:
        """One for each width."""
        return [cls(where, width) for width in WIDTHS]

    @property
    def settings(self) -> dict[str, Any]:
        """The width."""
        return {"width": self.width}

    @classmethod
    def build(cls, where: str, settings: Mapping[str, Any]) -> Self:
        """With its width."""
        return cls(where, float(settings["width"]))

    def columns(self, seen: SeenMotion) -> FloatArray:
        """State of the bristles, shape (n, 1)."""
        return seen.slip(self.width, 0.0)[:, None]

    def own_columns(self, seen: SeenMotion) -> FloatArray:
        """What an earlier bend leaves until they slide, shape (n, 1)."""
        return 0.5 * (seen.slip(self.width, 1.0) - seen.slip(self.width, -1.0))[:, None]

    def allowed(self, x: FloatArray, stiffness: float, motions: Sequence[SeenMotion]) -> bool:
        """The motor overcame it: friction is below the largest torque."""
        return 0.0 < float(x[0]) * stiffness < largest_torque(motions)

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """The torque at which it slides."""
        return {"torque": (float(x[0]) * stiffness, "N m")}

    def pattern(self) -> str:
        """What it leaves."""
        return (
            "at the same torque the spring is wound less when the joint moves on and more when it has turned"
        )
