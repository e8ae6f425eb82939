"""Process forces that are larger or smaller than assumed, or turned about the tool."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.course import BEGINS, CHANGES, DRIFTS, WEARS_AND_CHANGES
from doormill_ros.diagnosis.parts.effects.case import CutCase
from doormill_ros.diagnosis.parts.effects.elastic import LibraryEffect
from doormill_ros.robot_model.elastic.causes.process_force import ProcessForce, ProcessForceDirection


class ForceScale(LibraryEffect):
    """The true wrench is the assumed one times 1 + theta, at all tools, at one, or in one kind of feature."""

    name = ProcessForce.name
    of_force = True
    #: A mill gets blunt whatever wood it meets, and may be changed.
    courses = (BEGINS, CHANGES, DRIFTS, WEARS_AND_CHANGES)

    def __init__(self, where: str) -> None:
        """At all tools, one of them, or a kind of feature."""
        super().__init__(ProcessForce(where))

    def wrench(self, case: CutCase, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The factor alone."""
        return 1.0 + theta[:, 0] * case.cut_by(self.where), np.zeros(len(case))


class ForceTurn(LibraryEffect):
    """The true wrench is the assumed one turned about the tool by theta [rad]."""

    name = ProcessForceDirection.name
    of_force = True

    def __init__(self, where: str) -> None:
        """At all tools, one of them, or a kind of feature."""
        super().__init__(ProcessForceDirection(where))

    def wrench(self, case: CutCase, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The turn alone."""
        return np.ones(len(case)), theta[:, 0] * case.cut_by(self.where)
