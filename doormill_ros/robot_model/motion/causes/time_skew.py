"""The link encoder is read later than the motor's, or earlier."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.causes.cause import DELAY, MotionCause
from doormill_ros.robot_model.motion.causes.joint_damping import largest_damping
from doormill_ros.robot_model.motion.view import SeenMotion

_LARGEST = 0.1  #: s


class TimeSkew(MotionCause):
    """What the link encoder says at a time is where the joint was a skew before; x is a further skew [s]."""

    name = "time_skew"
    acts_on = DELAY
    of_delay = True
    of_robot = False

    def columns(self, seen: SeenMotion) -> FloatArray:
        """To first order about the delay at which the joint is seen, shape (n, 1)."""
        return -seen.speed[:, None]

    def allowed(self, x: FloatArray, stiffness: float, motions: Sequence[SeenMotion]) -> bool:
        """Less than a tenth of a second; early only by more than damping, which looks alike and is likelier."""
        skew = float(x[0]) + motions[0].delay
        return 0.0 < skew < _LARGEST or largest_damping(motions) <= -skew * stiffness < _LARGEST * stiffness

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """Skew, positive when the link encoder is late; x holds all of it."""
        return {"skew": (float(x[0]), "s")}

    def pattern(self) -> str:
        """What it leaves."""
        return "the difference of the encoders follows the speed, whatever the torque"
