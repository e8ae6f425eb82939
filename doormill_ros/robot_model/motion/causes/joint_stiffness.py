"""The spring of a joint is harder or softer than the model's."""

from __future__ import annotations

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.view import SeenMotion


class MotionStiffness(MotionCause):
    """x is the compliance [rad / (N m)] beyond the model's."""

    name = "joint_stiffness"

    def columns(self, seen: SeenMotion) -> FloatArray:
        """Minus torque, shape (n, 1)."""
        return -seen.torque[:, None]

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """The stiffness that is right."""
        return {"stiffness": (stiffness, "N m / rad")}

    def pattern(self) -> str:
        """What it leaves."""
        return "the difference of the encoders follows the torque by another slope than the model's"
