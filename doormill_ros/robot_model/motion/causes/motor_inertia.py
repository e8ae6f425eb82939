"""The motor turns itself: torque that the spring does not see while the joint speeds up."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.view import SeenMotion

#: Share of the published inertia that is one of the motor, and how many times it.
_LEAST, _MOST = 0.3, 3.0


class MotorInertia(MotionCause):
    """x is the inertia behind the gear over the stiffness [s^2]: torque times ratio holds what speeds up the motor."""

    name = "motor_inertia"

    @classmethod
    def candidates(cls, where: str, motions: Sequence[SeenMotion]) -> Sequence[MotionCause]:
        """One where the inertia is published: without a size to expect, much else follows the acceleration."""
        return [cls(where)] if motions[0].motion.motor_inertia else []

    def columns(self, seen: SeenMotion) -> FloatArray:
        """Acceleration, shape (n, 1)."""
        return seen.acceleration[:, None]

    def allowed(self, x: FloatArray, stiffness: float, motions: Sequence[SeenMotion]) -> bool:
        """About the published one."""
        motion = motions[0].motion
        published = (motion.motor_inertia or 0.0) * motion.gear_ratio**2
        return _LEAST * published < float(x[0]) * stiffness < _MOST * published

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """Inertia at the joint."""
        return {"inertia": (float(x[0]) * stiffness, "kg m^2")}

    def pattern(self) -> str:
        """What it leaves."""
        return "the spring is wound less the more the joint speeds up, at the same torque"
