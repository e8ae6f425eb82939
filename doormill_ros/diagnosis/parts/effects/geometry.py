"""Links that are not as the table of the robot has them."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.course import BEGINS
from doormill_ros.diagnosis.parts.effects.case import CutCase
from doormill_ros.diagnosis.parts.effects.effect import Unloaded
from doormill_ros.robot_model.candidate import CauseParameter, number
from doormill_ros.robot_model.elastic.places import LINKS
from doormill_ros.units import UM

#: Of the first link length and angle are a displaced base, of the last one a displaced tool.
#: Links whose lengths doors may tell of: the first is a displaced base, the last one a displaced tool.
INNER_LINKS = LINKS[1:5]
_ANGLE = 1e-5  #: theta 1 of an angle [rad]


class LinkOffsets(Unloaded):
    """Theta is what is added to d, a [um], theta and alpha [1e-5 rad] of one link of a Denavit-Hartenberg table."""

    name = "link_geometry"
    check = "measure the robot's poses with a laser tracker"
    courses = (BEGINS,)  # a link is as it was made until something is run into
    rigid = True
    parameters = (CauseParameter("offset", "m", -0.1, 0.1, 2), CauseParameter("angle", "rad", -0.1, 0.1, 2))

    def __init__(self, where: str) -> None:
        """At a link."""
        super().__init__(where)
        self.limit([100.0, 100.0, 10.0, 10.0])

    def pattern(self) -> str:
        """What it leaves."""
        return "the tool is beside its place whether it cuts or not, by another way in every posture"

    def displacement(self, case: CutCase) -> FloatArray:
        """Along the axis of the link's joint and along its own x axis, and about them."""
        link, load = number(self.where), case.load
        along, across = load.axes[:, link - 1, :, 2], load.axes[:, link, :, 0]
        turned = np.cross(along, load.point - load.origin[:, link - 1])
        tilted = np.cross(across, load.point - load.origin[:, link])
        return case.along(np.stack([UM * along, UM * across, _ANGLE * turned, _ANGLE * tilted], axis=2))

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """d, a; theta, alpha."""
        values: FloatArray = theta * np.array([UM, UM, _ANGLE, _ANGLE])
        return values
