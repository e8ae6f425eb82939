"""A joint that gives way under the weight of the arm."""

from __future__ import annotations

from doormill_ros.diagnosis.pose.causes.cause import Coefficient, Columns, PoseCause, number
from doormill_ros.diagnosis.pose.chain import joint_turn
from doormill_ros.diagnosis.pose.view import SetView


class JointSag(PoseCause):
    """Turn of a joint in proportion to the torque of gravity about its axis."""

    name = "joint_sag"

    def __init__(self, where: str) -> None:
        """Put it at a joint."""
        self.where = where

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
