"""A joint whose true angle wanders about the recorded one, the same at every visit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import Coefficient, Columns, PoseCause
from doormill_ros.robot_model.pose.causes.hints import Hints
from doormill_ros.robot_model.pose.causes.joint_waves import JointWaves
from doormill_ros.robot_model.pose.chain import joint_turn
from doormill_ros.robot_model.pose.view import SetView

#: Orders that are tried for a joint's own angle without a hint where rows are few. From so many rows on a whole
#: spectrum is tried as well, and from so many more nothing else.
SPARSE = 16
SOME_ROWS, MANY_ROWS = 300, 2500
#: Orders up to here make a spectrum where all of them are fitted.
BROAD = 60


def dense_orders(sets: Sequence[SetView]) -> list[tuple[int, ...]]:
    """Orders that are tried without any hint, in the ways that the number of rows leaves open; few orders first."""
    rows = sum(len(data) for data in sets)
    tried = [SPARSE] if rows < SOME_ROWS else [BROAD] if rows >= MANY_ROWS else [SPARSE, BROAD]
    return [tuple(range(1, highest + 1)) for highest in tried]


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


class JointPeriodicError(JointWaves):
    """Fourier series of the joint's own angle: encoder, gear teeth, eccentricity."""

    name = "joint_periodic_error"

    @classmethod
    def candidates(cls, hints: Hints) -> Sequence[PoseCause]:
        """Every joint, with the orders that are looked for there."""
        return [cls(where, hints.orders[where]) for where in hints.joints]

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """Amplitudes of cosine and sine."""
        return tuple(
            Coefficient(name, "rad", size_group(self.where, order, self.orders), 5e-4)
            for order, name in self.wave_names()
        )

    @property
    def driver_elsewhere(self) -> str:
        """The joint's angle: turns of two parallel joints by one angle may stand for a third thing."""
        return f"angle of {self.where}"

    def spectrum(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Orders and their amplitudes."""
        pairs = x.reshape(-1, 2)
        return np.array(self.orders, dtype=float), np.hypot(pairs[:, 0], pairs[:, 1])

    def columns(self, view: SetView) -> list[Columns]:
        """Turn of the joint."""
        return [Columns(joint_turn(number(self.where)), 0, self.waves(view))]

    def pattern(self) -> str:
        """What it leaves."""
        return f"the residual angle of {self.where} is a repeating curve of its own angle"
