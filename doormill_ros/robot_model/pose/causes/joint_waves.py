"""What causes have in common that repeat with a joint's own angle: waves a turn, each with two amplitudes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.view import SetView


def harmonics(angle: FloatArray, orders: Sequence[int]) -> FloatArray:
    """Cos and sin of every order of an angle (n,), shape (n, 2 len(orders))."""
    phase = angle[:, None] * np.asarray(orders, dtype=float)
    return np.stack([np.cos(phase), np.sin(phase)], axis=2).reshape(len(angle), -1)


class JointWaves(PoseCause):
    """Fourier series of a joint's own angle.

    Attributes:
        orders: Waves a turn.
    """

    def __init__(self, where: str, orders: Sequence[int]) -> None:
        """Put it at a joint, with the orders to look for."""
        super().__init__(where)
        self.orders = tuple(int(order) for order in orders)

    @property
    def settings(self) -> dict[str, Any]:
        """The orders."""
        return {"orders": list(self.orders)}

    @classmethod
    def build(cls, where: str, settings: Mapping[str, Any], dh: FloatArray) -> PoseCause:
        """With the orders stated."""
        return cls(where, settings["orders"])

    def waves(self, view: SetView) -> FloatArray:
        """Cos and sin of every order of the joint's angle, shape (n, 2 len(orders))."""
        return harmonics(view.q[:, number(self.where) - 1], self.orders)

    def wave_names(self) -> list[tuple[int, str]]:
        """Order and name of every column of `waves`."""
        return [(order, f"{part}_{order}") for order in self.orders for part in ("cos", "sin")]
