"""A joint whose friction carries part of the load when it is pre-loaded."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import ALONE, DIRECTION, ElasticCause, index
from doormill_ros.robot_model.elastic.load_case import LoadCase


class JointFriction(ElasticCause):
    """Theta is the friction torque over the largest torque of the test.

    After a motion against the load friction already points along it and must turn round before
    the spring feels anything; after a motion along the load it is used up.
    """

    name = "joint_friction"
    direct = ALONE
    driver = DIRECTION
    parameters = (CauseParameter("torque", "N m", 0.0, 1e3),)
    scale = np.array([0.2])
    lower = np.array([0.0])
    upper = np.array([1.0])
    kinked = (0,)

    def pattern(self) -> str:
        """What it leaves."""
        return f"{self.where} gives way less than its spring when pre-loaded, by a part that does not grow"

    def starts(self, case: LoadCase) -> list[FloatArray]:
        """Small and large."""
        return [np.array([0.05]), np.array([0.4])]

    def hidden_state(self, case: LoadCase) -> FloatArray | None:
        """Unknown directions; a torque too small to tell its sign moves nothing anyway."""
        k = index(self.where)
        direction = case.direction[:, k]
        return np.where(direction == 0.0, 0.5, np.where(direction * case.torque[:, k] < 0.0, 1.0, 0.0))

    def twist(self, case: LoadCase, theta: FloatArray) -> FloatArray:
        """Minus the part of the spring that friction holds."""
        k = index(self.where)
        limit = theta[0] * case.largest_torque[k]
        held = np.clip(case.torque[:, k], -limit, limit)
        result: FloatArray = -(held / case.joint_stiffness[k])[:, None] * case.joint_twist(k)
        return result

    def derivative(self, case: LoadCase, theta: FloatArray) -> FloatArray:
        """Only trials beyond the friction torque know its size."""
        k = index(self.where)
        beyond = np.abs(case.torque[:, k]) > theta[0] * case.largest_torque[k]
        slope = -np.where(beyond, np.sign(case.torque[:, k]), 0.0) * case.largest_torque[k]
        result: FloatArray = ((slope / case.joint_stiffness[k])[:, None] * case.joint_twist(k))[:, :, None]
        return result

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Friction torque [N m], shape (1,)."""
        result: FloatArray = theta * case.largest_torque[index(self.where)]
        return result

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the friction torque [N m], shape (1,)."""
        result: FloatArray = np.asarray(values) / case.largest_torque[index(self.where)]
        return result
