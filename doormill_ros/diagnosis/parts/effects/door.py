"""Doors that give way to the mill."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.course import BEGINS
from doormill_ros.diagnosis.parts.effects.case import CutCase
from doormill_ros.diagnosis.parts.effects.effect import Effect

_NEWTON = 1e-8  #: that a newton moves the wood 1 m above the floor at theta 1 [m / N]


class YieldingDoor(Effect):
    """A door that its clamp holds below gives way above, out of its plane and along it; no cause of the contract.

    Out of the plane by the height and by its square, which is a lever and a bow; along the plane by the height.
    """

    name, named = "door_compliance", False
    of_robot = False
    courses = (BEGINS,)

    def __init__(self) -> None:
        """Three compliances."""
        super().__init__("clamp")
        self.limit([10.0, 10.0, 3.0], 0.0)

    def pattern(self) -> str:
        """What it leaves."""
        return "doors that give way under the mill, the more the higher it cuts"

    def columns(self, case: CutCase) -> FloatArray:
        """Wood is pushed away by the opposite of what pushes the tool, so that the tool is as much further on."""
        force, height = _NEWTON * case.load.force, np.maximum(case.height, 0.0)
        out, along = case.normal[:, 0] * force[:, 0], case.normal[:, 1] * force[:, 1]
        return np.column_stack([out * height, out * height**2, along * height])
