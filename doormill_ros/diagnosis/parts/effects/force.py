"""Process forces that are larger or smaller than assumed, or turned about the tool."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.parts.case import CutCase
from doormill_ros.diagnosis.parts.effects.effect import Effect
from doormill_ros.robot_model.candidate import CauseParameter

TOOL = "tool"


class _OnWrench(Effect):
    of_force = True

    def _acts(self, case: CutCase) -> BoolArray:
        return np.full(len(case), True) if self.where == TOOL else case.kind == self.where


class ForceScale(_OnWrench):
    """The true wrench is the assumed one times 1 + theta, at the tool or while it mills one kind of feature."""

    name = "process_force"
    wears = True  # a mill gets blunt whatever wood it meets, and may be changed
    parameters = (CauseParameter("factor", "1", 0.0, 10.0),)

    def __init__(self, where: str) -> None:
        """At the tool, or a kind of feature."""
        super().__init__(where)
        self.limit([0.2], -1.0, 9.0)

    def pattern(self) -> str:
        """What it leaves."""
        return "every deflection under the process force is off by the same share, in every posture"

    def wrench(self, case: CutCase, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The factor alone."""
        return 1.0 + theta[:, 0] * self._acts(case), np.zeros(len(case))

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """Factor."""
        return 1.0 + theta


class ForceTurn(_OnWrench):
    """The true wrench is the assumed one turned about the tool by theta [rad]."""

    name = "process_force_direction"
    parameters = (CauseParameter("angle", "rad", -3.2, 3.2),)

    def __init__(self, where: str) -> None:
        """At the tool, or a kind of feature."""
        super().__init__(where)
        self.limit([0.1], -1.6, 1.6)

    def pattern(self) -> str:
        """What it leaves."""
        return "deflections go as if the process force came from another side of the tool"

    def wrench(self, case: CutCase, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The turn alone."""
        return np.ones(len(case)), theta[:, 0] * self._acts(case)

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """Angle."""
        return np.array(theta)
