"""A controller that follows late: where the path bends the tool passes inside of it."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.course import BEGINS, CHANGES
from doormill_ros.diagnosis.parts.doors.late import LAGS
from doormill_ros.diagnosis.parts.effects.case import CutCase
from doormill_ros.diagnosis.parts.effects.effect import Unloaded
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.units import s_to_ms

_SQUARE = 1e-7  #: theta 1 is this squared half width of the stretch over which the path is a mean [m^2]
#: Cut of a right angle over that half width h: on each leg the mean lies h / 4 from the corner.
_CORNER = np.sqrt(2.0) / 4.0
_TIME = 1e-4  #: theta 1 is this squared time constant [s^2]
#: Cut of a right angle over the way T v of a first-order lag: least root of exp(-2 u) + (u - 1 + exp(-u))^2 over u.
_CORNER_IN_TIME = 0.509


class PathLag(Unloaded):
    """Theta tells over which stretch of itself the path is a mean, to first order in the curvature.

    The mean over h to either side of a point of a path of curvature k lies h^2 k / 6 towards the centre (the second
    moment of an even stretch), however fast the tool goes.
    """

    name = "path_lag"
    check = "mill the same pocket at half the feed: what a controller lags falls to a quarter"
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


class ServoLag(PathLag):
    """The same by time: theta tells the time constant T of a tool that follows its commands as T y' = x - y.

    Where T v is little beside the radius that is (T v)^2 / 2 towards the centre for each unit of curvature; what it is
    for more, and behind a corner, is worked out for the time constants of `LAGS`, the nearest of which fits best.
    """

    series = "lag"

    def __init__(self, lag: float) -> None:
        """At the controller, shaped as for the time constant `lag`, one of `LAGS` [s]."""
        super().__init__()
        self.lag, self.variant = lag, f"{s_to_ms(lag):g} ms"
        self.limit([lag**2 / _TIME], 0.0)

    def displacement(self, case: CutCase) -> FloatArray:
        """What passes along the normals."""
        column: FloatArray = _TIME / self.lag**2 * case.along(case.late[:, LAGS.index(self.lag)])
        return column[:, None]

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """How far from a right angle with long legs the tool passes at the feed of half of the points."""
        lag: FloatArray = np.sqrt(_TIME * np.maximum(theta, 0.0))
        return _CORNER_IN_TIME * float(np.median(case.feed)) * lag
