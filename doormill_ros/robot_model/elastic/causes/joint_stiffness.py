"""A joint that is softer or stiffer than the model has it."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import ALONE, OWN_TORQUE, LinearTwist, index
from doormill_ros.robot_model.elastic.load_case import LoadCase


class JointStiffness(LinearTwist):
    """K0 / K - 1 is fitted: the joint turns by (1 + theta) torque / K0."""

    name = "joint_stiffness"
    direct = ALONE
    driver = OWN_TORQUE
    check = "load the joint with a known weight"
    parameters = (CauseParameter("stiffness", "N m / rad", 1e3, 1e8),)
    scale = np.array([0.3])
    lower = np.array([-0.9])
    upper = np.array([30.0])

    def pattern(self) -> str:
        """What it leaves."""
        return f"the residual of {self.where} grows in proportion to its torque, whatever came before"

    def unit(self, case: LoadCase) -> FloatArray:
        """Give of the model's own spring."""
        k = index(self.where)
        result: FloatArray = (case.torque[:, k, None] / case.joint_stiffness[k] * case.joint_twist(k))[
            :, :, None
        ]
        return result

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Stiffness [N m / rad], shape (1,)."""
        result: FloatArray = case.joint_stiffness[index(self.where)] / (1.0 + theta)
        return result

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the stiffness [N m / rad], shape (1,)."""
        result: FloatArray = case.joint_stiffness[index(self.where)] / np.asarray(values) - 1.0
        return result
