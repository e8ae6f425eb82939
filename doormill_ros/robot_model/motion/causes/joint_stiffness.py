"""The spring of a joint is harder or softer than the model's."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.causes.cause import SPRING, TORQUE, MotionCause
from doormill_ros.robot_model.motion.view import SeenMotion

_BEYOND = 3.0  #: times what noise alone makes a spring look harder


class MotionStiffness(MotionCause):
    """x is the compliance [rad / (N m)] beyond the model's."""

    name = "joint_stiffness"
    acts_on = SPRING
    follows = TORQUE
    of_spring = True

    def columns(self, seen: SeenMotion) -> FloatArray:
        """Minus torque, shape (n, 1)."""
        return -seen.torque[:, None]

    def allowed(self, x: FloatArray, stiffness: float, motions: Sequence[SeenMotion]) -> bool:
        """Not where the noise that is left in the torque makes the spring look as much harder."""
        noise = max(seen.motion.torque_noise or 0.0 for seen in motions)
        moving = float(np.var(np.concatenate([seen.torque for seen in motions])))
        harder: float = noise**2 / max(moving, 1e-30) / stiffness
        return not -_BEYOND * harder < float(x[0]) < 0.0

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """The stiffness that is right."""
        return {"stiffness": (stiffness, "N m / rad")}

    def pattern(self) -> str:
        """What it leaves."""
        return "the difference of the encoders follows the torque by another slope than the model's"
