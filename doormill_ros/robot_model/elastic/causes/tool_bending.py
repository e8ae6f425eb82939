"""A mill that gives way at its tip across its axis."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import LinearTwist
from doormill_ros.robot_model.elastic.load_case import LoadCase

_UNIT = 1e-6  #: theta 1 [m / N]


class ToolBending(LinearTwist):
    """The tip moves by force over stiffness, both across the tool's axis; 1 / stiffness is fitted."""

    name = "tool_bending"
    places = ("tool",)
    check = "mill the same pocket with a shorter mill"
    parameters = (CauseParameter("stiffness", "N / m", 1e3, 1e12),)
    scale = np.array([0.3])
    lower = np.array([0.0])
    upper = np.array([1e3])

    def pattern(self) -> str:
        """What it leaves."""
        return "the mill gives way in proportion to the force across it, in every posture alike"

    def unit(self, case: LoadCase) -> FloatArray:
        """Displacement without a turn."""
        axis = case.axes[:, 6, :, 2]
        across = case.force - np.sum(case.force * axis, axis=1, keepdims=True) * axis
        return np.concatenate([_UNIT * across, np.zeros_like(across)], axis=1)[:, :, None]

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Stiffness [N / m], shape (1,)."""
        return 1.0 / (_UNIT * np.maximum(theta, 1e-9))

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the stiffness [N / m], shape (1,)."""
        return 1.0 / (_UNIT * np.asarray(values, dtype=float))
