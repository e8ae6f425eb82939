"""A joint whose true angle wanders about the recorded one, the same at every visit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.diagnosis.pose.causes.cause import Coefficient, Columns, PoseCause, number
from doormill_ros.diagnosis.pose.chain import joint_turn
from doormill_ros.diagnosis.pose.view import SetView


def harmonics(angle: np.ndarray, orders: Sequence[int]) -> np.ndarray:
    """Cos and sin of every order of an angle (n,), shape (n, 2 len(orders))."""
    phase = angle[:, None] * np.asarray(orders, dtype=float)
    return np.stack([np.cos(phase), np.sin(phase)], axis=2).reshape(len(angle), -1)


#: Orders up to here make a spectrum where all of them are fitted.
BROAD = 60


def size_group(where: str, order: int, orders: Sequence[int]) -> str:
    """Which amplitudes share a typical size.

    Many rows tell a spectrum. The joints of a robot hold gears of one make, so it is learnt by octaves for all
    joints together, whatever part of a turn each was visited on. That is the spectrum of a smooth random curve:
    away from the visited angles it goes to zero within a wave or so, where the few orders that survive with sizes of
    their own would swing on. Few rows, and the sharp lines beyond the spectrum, tell single orders.
    """
    if order <= BROAD and set(range(1, BROAD + 1)) <= set(orders):
        return f"octave {order.bit_length()}"
    return f"{where} order {order}"


class JointPeriodicError(PoseCause):
    """Fourier series of the joint's own angle: encoder, gear teeth, eccentricity."""

    name = "joint_periodic_error"

    def __init__(self, where: str, orders: Sequence[int]) -> None:
        """Put it at a joint, with the orders to look for."""
        self.where = where
        self.orders = tuple(int(order) for order in orders)

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """Amplitudes of cosine and sine."""
        return tuple(
            Coefficient(f"{part}_{order}", "rad", size_group(self.where, order, self.orders), 5e-4)
            for order in self.orders
            for part in ("cos", "sin")
        )

    def columns(self, view: SetView) -> list[Columns]:
        """Turn of the joint."""
        k = number(self.where)
        return [Columns(joint_turn(k), 0, harmonics(view.q[:, k - 1], self.orders))]

    def pattern(self) -> str:
        """What it leaves."""
        return f"the residual angle of {self.where} is a repeating curve of its own angle"
