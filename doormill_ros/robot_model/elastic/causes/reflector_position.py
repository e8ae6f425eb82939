"""A reflector that sits elsewhere on its link than stated."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause, Setup
from doormill_ros.robot_model.elastic.load_case import LoadCase


class ReflectorPosition(ElasticCause):
    """The true position is the stated one plus the offset, in the frame of the link."""

    name = "reflector_position"
    places = None
    direct = "turn the last joints and measure where the reflector sits"
    acts_in = "reflector"
    parameters = (CauseParameter("offset", "m", -0.2, 0.2, 3),)
    scale = np.full(3, 0.02)
    lower = np.full(3, -0.5)
    upper = np.full(3, 0.5)
    stage = "setup"
    of_robot = False

    def pattern(self) -> str:
        """What it leaves."""
        return f"only reflector {self.where} disagrees, by the rotation of its link times a constant lever"

    def setup(self, setup: Setup, theta: FloatArray) -> None:
        """Move the reflector."""
        setup.reflector_offset[self.where] = setup.reflector_offset.get(self.where, np.zeros(3)) + theta

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Offset [m], shape (3,)."""
        return np.array(theta)

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the offset [m], shape (3,)."""
        return np.array(values)
