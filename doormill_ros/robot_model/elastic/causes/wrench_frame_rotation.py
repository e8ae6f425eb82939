"""A force sensor that is mounted at another angle than stated."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import WRENCH, ElasticCause, Setup
from doormill_ros.robot_model.elastic.load_case import LoadCase


class WrenchFrameRotation(ElasticCause):
    """The true rotation from sensor to flange axes is the stated one plus this angle."""

    name = "wrench_frame_rotation"
    places = ("sensor",)
    direct = "hang a known mass on the force sensor and turn the flange"
    driver = WRENCH
    parameters = (CauseParameter("angle", "rad", -np.pi, np.pi),)
    scale = np.array([0.05])
    lower = np.array([-np.pi])
    upper = np.array([np.pi])
    stage = "setup"
    of_robot = False

    def pattern(self) -> str:
        """What it leaves."""
        return (
            "residuals turn with the flange: the load seems to come from a direction rotated about its axis"
        )

    def setup(self, setup: Setup, theta: FloatArray) -> None:
        """Turn the wrench."""
        setup.wrench_angle += float(theta[0])

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Angle to add to the stated one [rad], shape (1,)."""
        return np.array(theta)

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the angle [rad], shape (1,)."""
        return np.array(values)
