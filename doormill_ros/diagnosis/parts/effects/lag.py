"""A controller that follows late: where the path bends the tool passes inside of it."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.course import BEGINS, CHANGES
from doormill_ros.diagnosis.parts.case import CutCase
from doormill_ros.diagnosis.parts.effects.effect import Unloaded
from doormill_ros.robot_model.candidate import CauseParameter

_SQUARE = 1e-7  #: theta 1 is this squared half width of the stretch over which the path is a mean [m^2]
#: Cut of a right angle over that half width h: on each leg the mean lies h / 4 from the corner.
_CORNER = np.sqrt(2.0) / 4.0


class PathLag(Unloaded):
    """Theta tells over which stretch of itself the path is a mean, to first order in the curvature.

    The mean over h to either side of a point of a path of curvature k lies h^2 k / 6 towards the centre (the second
    moment of an even stretch); of a first-order lag of the time constant T at the speed v it is (T v)^2 k.
    """

    name = "path_lag"
    of_robot = False
    courses = (BEGINS, CHANGES)  # the setting of a controller
    parameters = (CauseParameter("corner", "m", 0.0, 1e-2),)

    def __init__(self) -> None:
        """At the controller."""
        super().__init__("controller")
        self.limit([2.0], 0.0)

    def pattern(self) -> str:
        """What it leaves."""
        return "walls of tight arcs are left standing on the outside and straight ones are not"

    def displacement(self, case: CutCase) -> FloatArray:
        """By curvature along the normals."""
        column: FloatArray = _SQUARE / 6.0 * case.along(case.bend)
        return column[:, None]

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """How far from a right angle with long legs the tool passes."""
        corner: FloatArray = _CORNER * np.sqrt(_SQUARE * np.maximum(theta, 0.0))
        return corner
