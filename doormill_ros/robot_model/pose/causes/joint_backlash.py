"""A joint that stands off its recorded angle to the side from which it came, or to the other one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import Coefficient, Columns, PoseCause, Reported
from doormill_ros.robot_model.pose.chain import Placement, joint_turn
from doormill_ros.robot_model.pose.view import SetView


class PoseBacklash(PoseCause):
    """Half the gap ahead or behind, by the direction of the last motion between recorded rows.

    The coefficient is positive where the joint goes beyond its recorded angle, and negative where it stops short, as
    play behind the encoder does.
    """

    name = "joint_backlash"

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """The gap."""
        return (Coefficient("gap", "rad", f"backlash {self.where}", 1e-3),)

    def columns(self, view: SetView) -> list[Columns]:
        """For a positive gap: beyond the recorded angle, above it after a motion upwards."""
        k = number(self.where)
        return [Columns(joint_turn(k), 0, 0.5 * view.last_motion[:, k - 1 : k])]

    @staticmethod
    def side(gap: float) -> str:
        """Where the joint stands for a coefficient [rad]: 'short' of its recorded angle or 'beyond' it."""
        return "beyond" if gap > 0.0 else "short"

    def reported(self, x: FloatArray, std: FloatArray, seen: Sequence[tuple[SetView, Placement]]) -> Reported:
        """The size of the gap, and to which side it opens."""
        gap = super().reported(x, std, seen)["gap"]
        return {"gap": {**gap, "value": abs(gap["value"]), "side": self.side(gap["value"])}}

    def meaning(self, reported: Mapping[str, Mapping[str, Any]]) -> str:
        """To which side it opens: the gap itself is a size."""
        said = {
            "short": "stops half its gap short of the recorded angle, as play behind the encoder does.",
            "beyond": "goes half its gap beyond the recorded angle, which play behind the encoder does not do.",
        }
        return f"{self.where.capitalize()} {said[reported['gap']['side']]}"

    def pattern(self) -> str:
        """What it leaves."""
        return f"the residual angle of {self.where} jumps with the direction of its last motion"
