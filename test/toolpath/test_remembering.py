"""Only a robot that remembers how its joints moved is corrected for the directions of a path once more."""

import numpy as np
import pytest

from doormill_ros.robot_model.elastic.causes.registry import build_cause
from doormill_ros.robot_model.elastic.compliance import remembers
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel, SizedCause
from doormill_ros.robot_model.gravity.model import SaggingModel


class Counted:
    """Joint springs that count how many postures they are asked for, and say whether they remember."""

    def __init__(self, springs, says):
        self.springs, self.remembers, self.asked = springs, says, 0

    def deflection(self, q, wrench, load_point, direction=None):
        self.asked += len(q)
        return self.springs.deflection(q, wrench, load_point)


def test_springs_are_asked_once_and_answer_the_same(cell):
    recipe = cell.recipe("thesis_190_0deg")
    once, again = Counted(cell.springs, False), Counted(cell.springs, True)
    found, expected = (cell.program(recipe, cell.T_base_door(recipe), model=m) for m in (once, again))
    assert once.asked < 0.8 * again.asked
    for a, b in zip(found.targets, expected.targets, strict=True):
        np.testing.assert_allclose(a.T_base_tool_corrected, b.T_base_tool_corrected, rtol=0.0, atol=1e-12)
        assert a.expected_error == pytest.approx(b.expected_error, abs=1e-12)


def test_a_model_remembers_by_what_it_has_beside_springs(cell, play):
    def extended(*causes):
        return ExtendedComplianceModel(cell.robot.name, cell.robot.dh, cell.robot.stiffness, causes)

    backlash = extended(SizedCause(build_cause("joint_backlash", "joint 1"), np.array([1e-4, 8.0])))
    assert not remembers(JointSpringModel(cell.robot))
    assert not remembers(extended())
    assert remembers(backlash)
    assert remembers(SaggingModel(backlash, None))
    assert not remembers(SaggingModel(extended(), None))
    assert remembers(play(np.zeros(6)))  # it does not tell
