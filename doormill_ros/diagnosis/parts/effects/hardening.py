"""A joint whose spring stiffens with what it carries, to first order."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.parts.effects.case import CutCase
from doormill_ros.diagnosis.parts.effects.elastic import LibraryEffect
from doormill_ros.robot_model.elastic.causes.cause import index
from doormill_ros.robot_model.elastic.causes.joint_hardening import JointHardening

_LEAST = 0.05  #: share of the give at no torque that is left at the largest one, at least


class Hardening(LibraryEffect):
    """Theta is the spring's give beyond the model's at no torque, and what it loses up to the largest one, as shares.

    K = K0 (1 + h |torque|) turns a joint by torque / K0 (1 - h |torque|) to first order in h.
    """

    courses = ()  # the law of a spring

    def __init__(self, where: str) -> None:
        """Joint."""
        super().__init__(JointHardening(where))
        self.limit([0.3, 0.3])
        self.lower, self.upper = np.array([-0.9, 0.0]), np.array([30.0, 30.0])

    def columns(self, case: CutCase) -> FloatArray:
        """Give of the model's spring, and that times the share of the largest torque."""
        k, load = index(self.where), case.load
        share = np.abs(load.torque[:, k]) / max(float(load.largest_torque[k]), 1e-9)
        give = case.along((load.torque[:, k] / load.joint_stiffness[k])[:, None] * load.joint_twist(k)[:, :3])
        return np.column_stack([give, -share * give])

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """Stiffness at no torque, and the h that gives way as much at the largest torque, too."""
        k, soft = index(self.where), 1.0 + theta[0]
        left = max(1.0 - theta[1] / soft, _LEAST)
        largest = max(float(case.load.largest_torque[k]), 1e-9)
        return np.array([case.load.joint_stiffness[k] / soft, (1.0 / left - 1.0) / largest])
