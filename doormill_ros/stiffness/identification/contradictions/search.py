"""All contradictions at once."""

from __future__ import annotations

from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.stiffness.identification.contradictions import displacements, method, setup
from doormill_ros.stiffness.identification.contradictions.finding import Contradiction, Evidence
from doormill_ros.stiffness.identification.recovery import Recovery
from doormill_ros.stiffness.identification.thesis_tests import ThesisData


def find_contradictions(data: ThesisData, recovery: Recovery) -> list[Contradiction]:
    """Prove every contradiction from the printed figures."""
    evidence = Evidence(data, recovery, Kinematics(data.robot))
    return [rule(evidence) for rule in (*displacements.RULES, *method.RULES, *setup.RULES)]
