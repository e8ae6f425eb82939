"""A process whose wrench is another than assumed: larger or smaller, or turned about the tool."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause, Setup
from doormill_ros.robot_model.elastic.load_case import LoadCase


class ProcessForce(ElasticCause):
    """The true wrench is the assumed one times 1 + theta."""

    name = "process_force"
    places = ("tool",)
    check = "mill a test cut at half the feed: a force changes with it, a spring does not"
    parameters = (CauseParameter("factor", "1", 0.0, 10.0),)
    scale = np.array([0.2])
    lower = np.array([-1.0])
    upper = np.array([9.0])
    stage = "setup"

    def pattern(self) -> str:
        """What it leaves."""
        return "every deflection under the process force is off by the same share, in every posture"

    def setup(self, setup: Setup, theta: FloatArray) -> None:
        """Scale the wrench."""
        setup.wrench_gain *= 1.0 + float(theta[0])

    def values(self, theta: FloatArray, case: LoadCase | None = None) -> FloatArray:
        """Factor, shape (1,)."""
        return 1.0 + theta

    def from_values(self, values: FloatArray, case: LoadCase | None = None) -> FloatArray:
        """From the factor, shape (1,)."""
        return np.asarray(values) - 1.0


class ProcessForceDirection(ElasticCause):
    """The true wrench is the assumed one turned about the tool by theta [rad]."""

    name = "process_force_direction"
    places = ("tool",)
    check = "mill a test cut in the opposite direction: a force turns with it"
    parameters = (CauseParameter("angle", "rad", -3.2, 3.2),)
    scale = np.array([0.1])
    lower = np.array([-1.6])
    upper = np.array([1.6])
    stage = "setup"

    def pattern(self) -> str:
        """What it leaves."""
        return "deflections go as if the process force came from another side of the tool"

    def setup(self, setup: Setup, theta: FloatArray) -> None:
        """Turn the wrench."""
        setup.process_angle += float(theta[0])

    def values(self, theta: FloatArray, case: LoadCase | None = None) -> FloatArray:
        """Angle [rad], shape (1,)."""
        return np.array(theta)

    def from_values(self, values: FloatArray, case: LoadCase | None = None) -> FloatArray:
        """From the angle [rad], shape (1,)."""
        return np.array(values)
