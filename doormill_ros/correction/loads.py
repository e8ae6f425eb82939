"""Loads on the tool along a plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from doormill_ros.arrays import BoolArray, FloatArray


@dataclass(frozen=True, eq=False)
class Loads:
    """What acts on n loaded tools, and how well that is known; base axes.

    Attributes:
        wrench: At the tool centre point, as the recipe assumes it, shape (n, 6) [N, N m].
        direction: Direction of each joint's motion, shape (n, 6).
        spread: Standard deviations of the wrench as independent wrenches, shape (n, 6, 6) [N, N m]: force along x,
            y and z of the tool, moment about them.
        bounded: Where nobody measured the wrench, shape (n,).
        kind: Of the feature that is milled, shape (n,).
    """

    wrench: FloatArray
    direction: FloatArray
    spread: FloatArray
    bounded: BoolArray
    kind: npt.NDArray[Any]

    def of(self, rows: BoolArray) -> Loads:
        """Some of them, shape (n,)."""
        return Loads(
            self.wrench[rows], self.direction[rows], self.spread[rows], self.bounded[rows], self.kind[rows]
        )


def certain(wrench: FloatArray, direction: FloatArray) -> Loads:
    """Loads known exactly; shapes (n, 6) each [N, N m], [-]."""
    n = len(wrench)
    return Loads(wrench, direction, np.zeros((n, 6, 6)), np.zeros(n, dtype=bool), np.full(n, ""))
