"""A tracker that reports lengths too long or too short."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.elastic.load_case import LoadCase


class TrackerScale(ElasticCause):
    """Reported displacement = factor times true displacement."""

    name = "tracker_scale"
    places = ("tracker",)
    direct = "measure a scale bar of known length with the tracker"
    scales_all = True
    parameters = (CauseParameter("factor", "1", 0.5, 2.0),)
    scale = np.array([0.1])
    lower = np.array([-0.5])
    upper = np.array([1.0])
    stage = "tracker"
    of_robot = False

    def pattern(self) -> str:
        """What it leaves."""
        return "every reported displacement is off by the same share"

    def observe(self, displacement: FloatArray, dt: FloatArray, theta: FloatArray) -> FloatArray:
        """The displacements times 1 + theta, shape (n, 3) [m]."""
        result: FloatArray = displacement * (1.0 + theta[0])
        return result

    def observe_derivative(self, displacement: FloatArray, dt: FloatArray, theta: FloatArray) -> FloatArray:
        """The displacement itself."""
        return displacement[:, :, None]

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Factor, shape (1,)."""
        return 1.0 + theta

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the factor, shape (1,)."""
        return np.asarray(values) - 1.0
