"""A joint axis that tilts as the joint turns."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.diagnosis.pose.causes.cause import Coefficient, Columns, PoseCause, number
from doormill_ros.diagnosis.pose.causes.joint_periodic_error import harmonics
from doormill_ros.diagnosis.pose.chain import direction
from doormill_ros.diagnosis.pose.view import SetView


class JointWobble(PoseCause):
    """Tilt of a joint axis that repeats with the joint's own angle: bearing and gear run-out."""

    name = "joint_wobble"

    def __init__(self, where: str, orders: Sequence[int]) -> None:
        """Put it at a joint, with the orders to look for."""
        self.where = where
        self.orders = tuple(int(order) for order in orders)

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """Amplitudes about x and y of the frame before the joint."""
        return tuple(
            Coefficient(f"{axis}_{part}_{order}", "rad", f"wobble {self.where} order {order}", 2e-4)
            for axis in "xy"
            for order in self.orders
            for part in ("cos", "sin")
        )

    def columns(self, view: SetView) -> list[Columns]:
        """Turn about the two axes across."""
        k = number(self.where)
        basis = harmonics(view.q[:, k - 1], self.orders)
        return [Columns(direction(k - 1, 3 + i), i * basis.shape[1], basis) for i in range(2)]

    def pattern(self) -> str:
        """What it leaves."""
        return f"the axis of {self.where} tilts with its own angle"
