"""A force sensor that reads too little or too much."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import WRENCH, ElasticCause, Setup
from doormill_ros.robot_model.elastic.load_case import LoadCase


class WrenchGain(ElasticCause):
    """The true wrench is the recorded one times the factor."""

    name = "wrench_gain"
    places = ("sensor",)
    direct = "hang a known mass on the force sensor"
    scales_all = True
    driver = WRENCH
    parameters = (CauseParameter("factor", "1", 0.2, 5.0),)
    scale = np.array([0.1])
    lower = np.array([-0.8])
    upper = np.array([4.0])
    stage = "setup"
    of_robot = False

    def pattern(self) -> str:
        """What it leaves."""
        return "every displacement is off by the same share, in every posture and direction"

    def setup(self, setup: Setup, theta: FloatArray) -> None:
        """Scale the wrench."""
        setup.wrench_gain *= 1.0 + float(theta[0])

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Factor, shape (1,)."""
        return 1.0 + theta

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the factor, shape (1,)."""
        return np.asarray(values) - 1.0
