"""A link encoder that counts more or less than the joint turns."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.view import SeenMotion

_LARGEST = 0.02


class EncoderScale(MotionCause):
    """x is the factor less one."""

    name = "encoder_scale"
    of_robot = False

    def columns(self, seen: SeenMotion) -> FloatArray:
        """The angle, shape (n, 1)."""
        return seen.motor[:, None]

    def allowed(self, x: FloatArray, stiffness: float, motions: Sequence[SeenMotion]) -> bool:
        """Within two percent."""
        return abs(float(x[0])) < _LARGEST

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """The factor."""
        return {"factor": (1.0 + float(x[0]), "1")}

    def pattern(self) -> str:
        """What it leaves."""
        return "the difference of the encoders grows in proportion to the angle"
