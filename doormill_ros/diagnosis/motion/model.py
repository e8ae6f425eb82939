"""A fitted model of one joint, and the robot model that it leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.model import JointModel
from doormill_ros.robot_model.motion.view import JointMotion


@dataclass(frozen=True, eq=False)
class JointFit:
    """A model of one joint.

    Attributes:
        members: Causes.
        delay: At which the joint is seen; the skew of a member is about it [s].
        x: Shared coefficients of each member.
        own: Coefficients of each member that belong to a recording, by recording.
        residual, held_out: Fitted, and predicted without the block, shape (n,) [rad]; 0 where the delay asks for what
            was not recorded.
        std: Standard deviations of x, by member, from the scatter of the blocks.
        own_std: The same of `own`.
    """

    members: tuple[MotionCause, ...]
    delay: float
    x: tuple[FloatArray, ...]
    own: tuple[tuple[FloatArray, ...], ...]
    residual: FloatArray
    held_out: FloatArray
    std: tuple[FloatArray, ...]
    own_std: tuple[tuple[FloatArray, ...], ...]

    @property
    def numbers(self) -> int:
        """How many numbers were fitted besides the offsets."""
        return sum(len(part) for part in self.x) + sum(len(one) for part in self.own for one in part)

    @property
    def late(self) -> float:
        """By how much the link encoder is late, negative where it is early [s]."""
        index = self.skew
        return self.delay + (0.0 if index is None else float(self.x[index][0]))

    @property
    def skew(self) -> int | None:
        """Index of the member that tells what is missing of the delay, if there is one."""
        return next((i for i, cause in enumerate(self.members) if cause.of_delay), None)

    @property
    def spring(self) -> int | None:
        """Index of the member that tells the compliance of the spring, if there is one."""
        return next((i for i, cause in enumerate(self.members) if cause.of_spring), None)

    def of(self, kind: type[MotionCause]) -> int | None:
        """Index of the member of a kind, if there is one."""
        return next((i for i, cause in enumerate(self.members) if isinstance(cause, kind)), None)


def stiffness_of(members: Sequence[MotionCause], x: Sequence[FloatArray], given: float) -> float:
    """Stiffness of the joint [N m / rad] by members with coefficients x, shape (k,) each; `given` without any."""
    for cause, part in zip(members, x, strict=True):
        if cause.of_spring:
            return 1.0 / max(1.0 / given + float(part[0]), 1e-12)
    return given


def coefficients(found: JointFit, index: int) -> FloatArray:
    """Coefficients of a member; the height alone, shape (1,), where the phase belongs to the recording."""
    if not found.members[index].phased:
        return found.x[index]
    return np.array([np.sqrt(np.mean([float(own @ own) for own in found.own[index]]))])


def model_of(found: JointFit, motion: JointMotion) -> JointModel:
    """The model that a fit leaves for the joint of a recording."""
    kept = [i for i, cause in enumerate(found.members) if not cause.of_delay]
    return JointModel(
        motion.joint,
        motion.stiffness,
        found.late,
        tuple(found.members[i] for i in kept),
        tuple(coefficients(found, i) for i in kept),
    )
