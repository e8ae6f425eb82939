"""Something in the cell that creeps while a trial lasts."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import TIME, ElasticCause
from doormill_ros.robot_model.elastic.load_case import LoadCase

_SPEED = 1e-7  #: theta 1 [m / s]


class DisplacementDrift(ElasticCause):
    """Reported displacement = true displacement + velocity times dt."""

    name = "thermal_drift"
    places = ("cell",)
    direct = "measure a fixed point again and again without any load"
    acts_in = "tracker"
    driver = TIME
    added_last = True
    parameters = (CauseParameter("velocity", "m / s", -1e-5, 1e-5, 3),)
    scale = np.ones(3)
    lower = np.full(3, -1000.0)
    upper = np.full(3, 1000.0)
    stage = "tracker"
    of_robot = False

    def pattern(self) -> str:
        """What it leaves."""
        return "the residual points one way in the room and grows with the time between the two measurements"

    def observe(self, displacement: FloatArray, dt: FloatArray, theta: FloatArray) -> FloatArray:
        """Add the drift."""
        return displacement + _SPEED * dt[:, None] * theta

    def observe_derivative(self, displacement: FloatArray, dt: FloatArray, theta: FloatArray) -> FloatArray:
        """Elapsed time along each axis."""
        return _SPEED * dt[:, None, None] * np.eye(3)

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Velocity [m/s], shape (3,)."""
        return _SPEED * theta

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the velocity [m/s], shape (3,)."""
        return np.asarray(values) / _SPEED
