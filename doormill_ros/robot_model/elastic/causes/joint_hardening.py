"""A joint whose spring stiffens with the torque: K = K0 (1 + h abs(torque))."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import ALONE, OWN_TORQUE, ElasticCause, index
from doormill_ros.robot_model.elastic.load_case import LoadCase


class JointHardening(ElasticCause):
    """Theta is model stiffness / K0 - 1, and h times the largest torque of the test."""

    name = "joint_hardening"
    direct = ALONE
    driver = OWN_TORQUE
    check = "load the joint with two known weights"
    parameters = (
        CauseParameter("stiffness", "N m / rad", 1e3, 1e8),
        CauseParameter("hardening", "1 / (N m)", 0.0, 0.1),
    )
    scale = np.array([0.3, 0.5])
    lower = np.array([-0.9, 0.0])
    upper = np.array([30.0, 30.0])
    generalises = "joint_stiffness"

    def pattern(self) -> str:
        """What it leaves."""
        return f"the residual of {self.where} bends over its torque: soft at small torque, stiff at large"

    def starts(self, case: LoadCase) -> list[FloatArray]:
        """No hardening, and a marked one."""
        return [np.array([0.0, 0.05]), np.array([1.0, 1.5])]

    def _parts(self, case: LoadCase, theta: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        k = index(self.where)
        share = np.abs(case.torque[:, k]) / case.largest_torque[k]
        give = (case.torque[:, k] / case.joint_stiffness[k])[:, None] * case.joint_twist(k)
        return give, share, 1.0 + theta[1] * share

    def twist(self, case: LoadCase, theta: FloatArray) -> FloatArray:
        """Difference to the model's spring."""
        give, _, stiffer = self._parts(case, theta)
        result: FloatArray = ((1.0 + theta[0]) / stiffer - 1.0)[:, None] * give
        return result

    def derivative(self, case: LoadCase, theta: FloatArray) -> FloatArray:
        """Of the quotient."""
        give, share, stiffer = self._parts(case, theta)
        return np.stack(
            [give / stiffer[:, None], (-(1.0 + theta[0]) * share / stiffer**2)[:, None] * give], axis=2
        )

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Stiffness at zero torque [N m / rad] and h, shape (2,)."""
        k = index(self.where)
        return np.array([case.joint_stiffness[k] / (1.0 + theta[0]), theta[1] / case.largest_torque[k]])

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From stiffness [N m / rad] and h, shape (2,)."""
        k = index(self.where)
        return np.array([case.joint_stiffness[k] / values[0] - 1.0, values[1] * case.largest_torque[k]])
