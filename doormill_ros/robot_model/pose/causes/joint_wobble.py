"""A joint axis that tilts as the joint turns."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import Coefficient, Columns, PoseCause
from doormill_ros.robot_model.pose.causes.hints import Hints
from doormill_ros.robot_model.pose.causes.joint_waves import JointWaves
from doormill_ros.robot_model.pose.chain import direction
from doormill_ros.robot_model.pose.view import SetView

#: Waves of a tilting axis; one wave a turn is, in the main, a wrong alpha or theta of the links next to it.
ORDERS = (2, 3, 4)


class JointWobble(JointWaves):
    """Tilt of a joint axis that repeats with the joint's own angle: bearing and gear run-out."""

    name = "joint_wobble"

    @classmethod
    def candidates(cls, hints: Hints) -> Sequence[PoseCause]:
        """Every joint, with few orders."""
        return [cls(where, ORDERS) for where in hints.joints]

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """Amplitudes about x and y of the frame before the joint."""
        return tuple(
            Coefficient(f"{axis}_{name}", "rad", f"wobble {self.where} order {order}", 2e-4)
            for axis in "xy"
            for order, name in self.wave_names()
        )

    def columns(self, view: SetView) -> list[Columns]:
        """Turn about the two axes across."""
        k, basis = number(self.where), self.waves(view)
        return [Columns(direction(k - 1, 3 + i), i * basis.shape[1], basis) for i in range(2)]

    def pattern(self) -> str:
        """What it leaves."""
        return f"the axis of {self.where} tilts with its own angle"
