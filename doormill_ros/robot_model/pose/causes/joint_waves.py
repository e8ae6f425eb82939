"""What causes have in common that repeat with a joint's own angle: waves a turn, each with two amplitudes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import CLEAR, PoseCause, Reported
from doormill_ros.robot_model.pose.chain import Placement
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

    def reported(self, x: FloatArray, std: FloatArray, seen: Sequence[tuple[SetView, Placement]]) -> Reported:
        """Amplitude of every order that is clear of zero, and its cosine and sine."""
        named = super().reported(x, std, seen)
        prefixes = (name.rsplit("_", 2)[0] + "_" if name.count("_") > 1 else "" for name in named)
        found: Reported = {}
        for prefix in dict.fromkeys(prefixes):
            for order in self.orders:
                c, s = named[f"{prefix}cos_{order}"], named[f"{prefix}sin_{order}"]
                size = float(np.hypot(c["value"], s["value"]))
                own = float(np.hypot(c["value"] * c["std"], s["value"] * s["std"]) / max(size, 1e-30))
                if size > CLEAR * own:
                    found[f"{prefix}order_{order}"] = {
                        "value": size,
                        "std": own,
                        "unit": "rad",
                        "cos": c["value"],
                        "sin": s["value"],
                        "cos_std": c["std"],
                        "sin_std": s["std"],
                    }
        return found
