"""A joint that stops short of where it should, depending on the side from which it came."""

from __future__ import annotations

from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import Coefficient, Columns, PoseCause
from doormill_ros.robot_model.pose.chain import joint_turn
from doormill_ros.robot_model.pose.view import SetView


class PoseBacklash(PoseCause):
    """Half the gap ahead or behind, by the direction of the last motion between recorded rows."""

    name = "joint_backlash"

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """The gap."""
        return (Coefficient("gap", "rad", f"backlash {self.where}", 1e-3),)

    def columns(self, view: SetView) -> list[Columns]:
        """The joint stands beyond its recorded angle when it came from below."""
        k = number(self.where)
        return [Columns(joint_turn(k), 0, 0.5 * view.last_motion[:, k - 1 : k])]

    def pattern(self) -> str:
        """What it leaves."""
        return f"the residual angle of {self.where} jumps with the direction of its last motion"
