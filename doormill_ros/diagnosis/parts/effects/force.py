"""Process forces that are larger or smaller than assumed, or turned about the tool."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.course import BEGINS, CHANGES, DRIFTS, WEARS_AND_CHANGES
from doormill_ros.diagnosis.parts.case import CutCase
from doormill_ros.diagnosis.parts.effects.effect import Effect
from doormill_ros.robot_model.candidate import CauseParameter


class ForceScale(Effect):
    """The true wrench is the assumed one times 1 + theta, at all tools, at one, or in one kind of feature."""

    name = "process_force"
    of_force = True
    #: A mill gets blunt whatever wood it meets, and may be changed.
    courses = (BEGINS, CHANGES, DRIFTS, WEARS_AND_CHANGES)
    parameters = (CauseParameter("factor", "1", 0.0, 10.0),)

    def __init__(self, where: str) -> None:
        """At all tools, one of them, or a kind of feature."""
        super().__init__(where)
        self.limit([0.2], -1.0, 9.0)

    def pattern(self) -> str:
        """What it leaves."""
        return "every deflection under the process force is off by the same share, in every posture"

    def wrench(self, case: CutCase, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The factor alone."""
        return 1.0 + theta[:, 0] * case.cut_by(self.where), np.zeros(len(case))

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """Factor."""
        return 1.0 + theta


class ForceTurn(Effect):
    """The true wrench is the assumed one turned about the tool by theta [rad]."""

    name = "process_force_direction"
    of_force = True
    parameters = (CauseParameter("angle", "rad", -3.2, 3.2),)

    def __init__(self, where: str) -> None:
        """At all tools, one of them, or a kind of feature."""
        super().__init__(where)
        self.limit([0.1], -1.6, 1.6)

    def pattern(self) -> str:
        """What it leaves."""
        return "deflections go as if the process force came from another side of the tool"

    def wrench(self, case: CutCase, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The turn alone."""
        return np.ones(len(case)), theta[:, 0] * case.cut_by(self.where)

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """Angle."""
        return np.array(theta)
