"""A joint that gives way under the weight of the arm."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import Coefficient, Columns, PoseCause
from doormill_ros.robot_model.pose.causes.hints import Hints
from doormill_ros.robot_model.pose.chain import joint_turn
from doormill_ros.robot_model.pose.view import SetView

#: Torque of gravity below which a joint's sag cannot be asked for [N m].
LEAST_TORQUE = 0.5


class JointSag(PoseCause):
    """Turn of a joint in proportion to the torque of gravity about its axis."""

    name = "joint_sag"

    @classmethod
    def candidates(cls, hints: Hints) -> Sequence[PoseCause]:
        """Joints that carry weight in one series at least."""
        moment = [view.gravity_moment for view in hints.sets]
        most = np.max([np.abs(m[:, :, 2]).max(axis=0) for m in moment], axis=0)
        return [cls(where) for where, torque in zip(hints.joints, most, strict=True) if torque > LEAST_TORQUE]

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """The compliance."""
        return (Coefficient("compliance", "rad / (N m)", f"sag {self.where}", 1e-4),)

    def columns(self, view: SetView) -> list[Columns]:
        """Torque of gravity about the joint axis."""
        k = number(self.where)
        return [Columns(joint_turn(k), 0, view.gravity_moment[:, k - 1, 2:])]

    def pattern(self) -> str:
        """What it leaves."""
        return f"the residual angle of {self.where} follows the torque of gravity about it"
