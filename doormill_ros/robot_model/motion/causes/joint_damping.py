"""Friction between motor and spring that grows with the speed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.causes.cause import DELAY, SPEED, MotionCause
from doormill_ros.robot_model.motion.view import SeenMotion
from doormill_ros.statistics import root_mean_square


def largest_damping(motions: Sequence[SeenMotion]) -> float:
    """Damping that takes all torque of some recordings [N m s / rad]."""
    speed, torque = (
        root_mean_square(np.concatenate([getattr(seen, name) for seen in motions]))
        for name in ("speed", "torque")
    )
    return torque / max(speed, 1e-12)


class JointDamping(MotionCause):
    """x is the damping over the stiffness [s]."""

    name = "joint_damping"
    acts_on = DELAY
    follows = SPEED

    def columns(self, seen: SeenMotion) -> FloatArray:
        """Speed, shape (n, 1)."""
        return seen.speed[:, None]

    def allowed(self, x: FloatArray, stiffness: float, motions: Sequence[SeenMotion]) -> bool:
        """The motor gave the torque that it takes."""
        return 0.0 < float(x[0]) * stiffness < largest_damping(motions)

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """Torque by speed."""
        return {"damping": (float(x[0]) * stiffness, "N m s / rad")}

    def pattern(self) -> str:
        """What it leaves."""
        return "the spring is wound less the faster the joint moves, at the same torque"
