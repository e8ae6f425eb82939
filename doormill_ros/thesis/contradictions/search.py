"""All contradictions at once."""

from __future__ import annotations

from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.thesis.contradictions import displacements, method, setup
from doormill_ros.thesis.contradictions.finding import Contradiction, Evidence
from doormill_ros.thesis.loading_tests import ThesisData
from doormill_ros.thesis.recovery import Recovery


def find_contradictions(data: ThesisData, recovery: Recovery) -> list[Contradiction]:
    """Prove every contradiction from the printed figures."""
    evidence = Evidence(data, recovery, Kinematics(data.robot))
    return [rule(evidence) for rule in (*displacements.RULES, *method.RULES, *setup.RULES)]
