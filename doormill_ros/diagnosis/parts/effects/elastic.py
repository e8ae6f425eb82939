"""Causes of the elastic library as they act on milled doors."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.parts.effects.case import TOOL, CutCase
from doormill_ros.diagnosis.parts.effects.effect import Effect
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause, LinearTwist
from doormill_ros.robot_model.elastic.causes.joint_backlash import DisplacementBacklash
from doormill_ros.robot_model.elastic.causes.tool_bending import ToolBending


class LibraryEffect(Effect):
    """A cause of the elastic library in milled doors: name, place, numbers, bounds and words are the library's."""

    def __init__(self, cause: ElasticCause) -> None:
        """Take over what the cause says of itself."""
        super().__init__(cause.where)
        self.name, self.variant, self.named = cause.name, cause.variant, cause.named
        self.parameters, self.generalises, self.check = cause.parameters, cause.generalises, cause.check
        self.courses = self.courses if self.named else ()
        self.scale, self.lower, self.upper = cause.scale, cause.lower, cause.upper
        self.cause = cause

    def pattern(self) -> str:
        """What it leaves."""
        return self.cause.pattern()

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """As the cause reports them."""
        return self.cause.values(theta, case.load)


class ElasticEffect(LibraryEffect):
    """A cause whose twist is in proportion to theta."""

    def __init__(self, cause: LinearTwist) -> None:
        """Of a cause at its place."""
        super().__init__(cause)

    def columns(self, case: CutCase) -> FloatArray:
        """Along the normals."""
        return case.along(self.cause.derivative(case.load, np.ones(self.size))[:, :3])


class MillBending(ElasticEffect):
    """Mills that bend: all alike, or one of them."""

    def __init__(self, where: str) -> None:
        """All tools, or one."""
        super().__init__(ToolBending(TOOL))
        self.where = where

    def columns(self, case: CutCase) -> FloatArray:
        """Along the normals that it cut."""
        return super().columns(case) * case.cut_by(self.where)[:, None]


class Gap(LibraryEffect):
    """Backlash of one joint that is open from a torque on; theta is the gap over 1e-4 rad.

    Only a few crossing torques are tried: more a door does not tell.
    """

    series = "crossing"

    def __init__(self, where: str, crossing: float) -> None:
        """Joint, and the torque from which its gap is open [N m]."""
        super().__init__(DisplacementBacklash(where))
        self.crossing, self.variant = crossing, f"{crossing:g} N m"
        self.limit([3.0], 0.0, 200.0)

    def columns(self, case: CutCase) -> FloatArray:
        """Of a gap of 1e-4 rad; where the last motion is not known half of it, which is expected."""
        theta = self.cause.from_values(np.array([1e-4, self.crossing]), case.load)
        opened = self.cause.twist(case.load, theta)
        share = self.cause.hidden_state(case.load)
        return case.along(opened[:, :3] * (1.0 if share is None else share[:, None]))[:, None]

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """Gap and crossing torque."""
        return np.array([1e-4 * theta[0], self.crossing])
