"""A tracker whose frame is turned against the robot's base frame."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import cross, rotation_from_vector
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.elastic.load_case import LoadCase


class TrackerFrameRotation(ElasticCause):
    """Reported displacement = R(rotation vector) times true displacement."""

    name = "tracker_frame_rotation"
    places = ("tracker",)
    direct = "measure three fixed points of the robot's base with the tracker"
    parameters = (CauseParameter("rotation_vector", "rad", -0.5, 0.5, 3),)
    scale = np.full(3, 0.02)
    lower = np.full(3, -0.7)
    upper = np.full(3, 0.7)
    stage = "tracker"
    of_robot = False

    def pattern(self) -> str:
        """What it leaves."""
        return "every residual stands at right angles to the displacement, about one axis fixed in the room"

    def observe(self, displacement: FloatArray, dt: FloatArray, theta: FloatArray) -> FloatArray:
        """Turn."""
        result: FloatArray = displacement @ rotation_from_vector(theta).T
        return result

    def observe_derivative(self, displacement: FloatArray, dt: FloatArray, theta: FloatArray) -> FloatArray:
        """Of the small turn that follows: exact at zero, a fine descent direction elsewhere."""
        turned = self.observe(displacement, dt, theta)
        return np.stack([cross(axis, turned) for axis in np.eye(3)], axis=2)

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Rotation vector [rad], shape (3,)."""
        return np.array(theta)

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the rotation vector [rad], shape (3,)."""
        return np.array(values)
