"""A base that tilts on its foundation."""

from __future__ import annotations

from doormill_ros.robot_model.elastic.causes.cause import WRENCH
from doormill_ros.robot_model.elastic.causes.tilting_mount import TiltingMount


class BaseCompliance(TiltingMount):
    """The whole robot, its base included, tilts about x and y of the base frame."""

    name = "base_compliance"
    places = ("base",)
    direct = "put reflectors on the foot of the robot"
    driver = WRENCH
    check = "press against the robot and read a dial at its foot"
    frame = 0
    first_link = 0
    unit_compliance = 1e-7

    def pattern(self) -> str:
        """What it leaves."""
        return "the whole robot tilts with the overturning moment, reflectors near the base included"
