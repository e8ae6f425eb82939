"""The library of causes of a difference between the two encoders of a gear: one line a cause."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.causes.encoder_scale import EncoderScale
from doormill_ros.robot_model.motion.causes.joint_backlash import JointBacklash
from doormill_ros.robot_model.motion.causes.joint_damping import JointDamping
from doormill_ros.robot_model.motion.causes.joint_friction import MotionFriction
from doormill_ros.robot_model.motion.causes.joint_periodic_error import MotionPeriodicError
from doormill_ros.robot_model.motion.causes.joint_stiffness import MotionStiffness
from doormill_ros.robot_model.motion.causes.motor_inertia import MotorInertia
from doormill_ros.robot_model.motion.causes.spring_damping import SpringDamping, TorqueSkew
from doormill_ros.robot_model.motion.causes.time_skew import TimeSkew
from doormill_ros.robot_model.motion.view import SeenMotion

#: Among equals the first goes first.
LIBRARY: tuple[type[MotionCause], ...] = (
    TimeSkew,
    MotorInertia,
    MotionStiffness,
    EncoderScale,
    MotionFriction,
    JointBacklash,
    JointDamping,
    SpringDamping,
    TorqueSkew,
    MotionPeriodicError,
)


def candidates(where: str, motions: Sequence[SeenMotion]) -> list[MotionCause]:
    """Every cause that could act in a joint."""
    return [cause for kind in LIBRARY for cause in kind.candidates(where, motions)]


def build_cause(name: str, where: str, settings: Mapping[str, Any]) -> MotionCause:
    """The cause of a model's file.

    Raises:
        KeyError: A setting is missing.
        ValueError: The library has no such cause.
    """
    for kind in LIBRARY:
        if kind.name == name:
            return kind.build(where, settings)
    raise ValueError(f"{name!r} is no cause of a joint in motion")
