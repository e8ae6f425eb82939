"""A tool mount that tilts on the flange."""

from __future__ import annotations

from doormill_ros.robot_model.elastic.causes.cause import WRENCH
from doormill_ros.robot_model.elastic.causes.tilting_mount import TiltingMount


class ToolCompliance(TiltingMount):
    """Everything on the flange tilts about x and y of the flange frame, at its origin."""

    name = "tool_compliance"
    places = ("flange",)
    direct = "put one reflector on the flange and one on the tool"
    acts_in = "tool"
    driver = WRENCH
    check = "press against the spindle and read a dial on the flange"
    frame = 6
    first_link = 6
    unit_compliance = 1e-6

    def pattern(self) -> str:
        """What it leaves."""
        return "the tool tilts with the moment at the flange while the arm behind it stays as simulated"
