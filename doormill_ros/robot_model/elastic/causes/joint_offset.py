"""A joint whose true angle differs from the commanded one."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause, Setup, index
from doormill_ros.robot_model.elastic.load_case import LoadCase


class JointOffset(ElasticCause):
    """The posture in which load and springs act has this angle added to one joint."""

    name = "joint_offset"
    direct = "calibrate the zero positions of the joints"
    parameters = (CauseParameter("angle", "rad", -0.3, 0.3),)
    scale = np.array([0.02])
    lower = np.array([-0.5])
    upper = np.array([0.5])
    stage = "setup"

    def pattern(self) -> str:
        """What it leaves."""
        return f"residuals are those of an arm that stands slightly differently from {self.where} on"

    def setup(self, setup: Setup, theta: FloatArray) -> None:
        """Turn the joint."""
        setup.joint_offset[index(self.where)] += float(theta[0])

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Angle [rad], shape (1,)."""
        return np.array(theta)

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the angle [rad], shape (1,)."""
        return np.array(values)
