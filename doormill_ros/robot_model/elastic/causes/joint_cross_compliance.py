"""A joint bearing that tilts about the two axes across the joint axis."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import WRENCH, LinearTwist, index
from doormill_ros.robot_model.elastic.load_case import LoadCase

_SCALE = 1e-7  #: theta 1 is this compliance [rad / (N m)]


class JointCrossCompliance(LinearTwist):
    """Everything behind the joint tilts about the joint's origin by compliance times transverse moment."""

    name = "joint_cross_compliance"
    direct = "put reflectors on both sides of the joint's bearing"
    driver = WRENCH
    parameters = (CauseParameter("compliance", "rad / (N m)", 0.0, 1e-4),)
    scale = np.array([3.0])
    lower = np.array([0.0])
    upper = np.array([1000.0])

    @property
    def also_at(self) -> tuple[str, ...]:
        """The links that end in the bearing."""
        before = index(self.where)
        return f"link {before}", f"link {before + 1}"

    def pattern(self) -> str:
        """What it leaves."""
        return f"everything behind {self.where} tilts across its axis, in proportion to the moment there"

    def unit(self, case: LoadCase) -> FloatArray:
        """Tilt by the transverse moment."""
        k = index(self.where)
        moment = case.moment[:, k] - case.torque[:, k, None] * case.axis(k)
        return case.rotate(_SCALE * moment, k, k + 1)[:, :, None]

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Compliance [rad / (N m)], shape (1,)."""
        return theta * _SCALE

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the compliance [rad / (N m)], shape (1,)."""
        return np.asarray(values) / _SCALE
