"""The weight of what nobody told of: joints carry it beside the process, in their springs and in their gaps."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.course import BEGINS, CHANGES
from doormill_ros.diagnosis.parts.effects.case import TOOL, CutCase
from doormill_ros.diagnosis.parts.effects.effect import Effect
from doormill_ros.robot_model.candidate import CauseParameter, number
from doormill_ros.robot_model.elastic.places import LINKS
from doormill_ros.robot_model.gravity.weights import FLANGE
from doormill_ros.units import GRAVITY


class _Weight(Effect):
    """Torques in proportion to theta."""

    name = "gravity_sag"
    check = "mill a shallow pocket at the ends of the door's edge, where the arm reaches farthest and least"
    of_weight = True
    rigid = True
    courses = (BEGINS, CHANGES)  # what hangs on an arm is there or not

    def pattern(self) -> str:
        """What it leaves."""
        return "the tool hangs lower than sent, most where the arm reaches far, whether it cuts or not"

    def torques(self, case: CutCase) -> FloatArray:
        """About each joint for theta = 1, shape (n, 6, p) [N m]; computed once for each case."""
        key = (*self.identity, "torques")
        if key not in case.unloaded:
            case.unloaded[key] = self._torques(case)
        return case.unloaded[key]

    def _torques(self, case: CutCase) -> FloatArray:
        raise NotImplementedError

    def columns(self, case: CutCase) -> FloatArray:
        """What the springs make of the torques."""
        give = case.joints() / case.load.joint_stiffness
        columns: FloatArray = np.einsum("nk,nkp->np", give, self.torques(case))
        return columns


class ToolWeight(_Weight):
    """Theta is a mass at the flange [kg], and mass times how far along the spindle its centre lies [kg m]."""

    parameters = (CauseParameter("mass", "kg", 0.0, 1e3), CauseParameter("centre", "m", -2.0, 2.0))

    def __init__(self) -> None:
        """At the tool."""
        super().__init__(TOOL)
        self.limit([5.0, 1.0])

    def _torques(self, case: CutCase) -> FloatArray:
        flange, axis = case.load.origin[:, FLANGE], case.load.axes[:, FLANGE, :, 2]
        at_flange = _of_kilogram(case, flange, FLANGE)
        return np.stack([at_flange, _of_kilogram(case, flange + axis, FLANGE) - at_flange], axis=2)

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """Mass and centre."""
        return np.array([theta[0], theta[1] / max(abs(theta[0]), 1e-9)])


class LinkWeight(_Weight):
    """Theta is a mass [kg] half way between the joints of a link: nobody tells where its centre is."""

    parameters = (CauseParameter("mass", "kg", 0.0, 1e4),)

    def __init__(self, where: str) -> None:
        """At a link."""
        super().__init__(where)
        self.limit([20.0], 0.0)

    def _torques(self, case: CutCase) -> FloatArray:
        link, origin = number(self.where), case.load.origin
        return _of_kilogram(case, 0.5 * (origin[:, link - 1] + origin[:, link]), link)[:, :, None]

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """Mass."""
        return np.array(theta)


def _of_kilogram(case: CutCase, centre: FloatArray, link: int) -> FloatArray:
    """Torque about each joint, shape (n, 6) [N m], by a kilogram at points of a link, shape (n, 3) [m]."""
    force = np.array([0.0, 0.0, -GRAVITY])
    moment = np.cross(centre[:, None] - case.load.origin[:, :link], force)
    torque = np.zeros((len(case), 6))
    torque[:, :link] = np.sum(case.load.axes[:, :link, :, 2] * moment, axis=2)
    return torque


def weights() -> list[Effect]:
    """At the tool and at every link that moves it down."""
    return [ToolWeight(), *map(LinkWeight, LINKS[1:])]
