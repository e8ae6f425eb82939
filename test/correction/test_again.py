"""What is corrected again where some loads have become others is what all loads together give."""

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.correction.loaded_robot import LoadedRobot
from doormill_ros.correction.loads import Loads
from doormill_ros.correction.worth import worth_of
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.causes.registry import build_cause
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel, SizedCause

N, EACH = 40, 2  #: targets, and loads of each


@pytest.fixture(scope="module")
def loaded():
    """A robot whose joints remember how they came, one of them by the largest torque of all."""
    layout = load_layout()
    robot = load_robot(layout.robot)
    causes = [
        SizedCause(build_cause("joint_backlash", "joint 1"), np.array([1e-4, 8.0])),
        SizedCause(build_cause("joint_friction", "joint 3"), np.array([20.0])),
    ]
    model = ExtendedComplianceModel(robot.name, robot.dh, robot.stiffness, causes)
    return LoadedRobot(Kinematics(robot), model, layout.T_flange_tool, 1e-6, worth_of(robot, 4e-5, model))


def drawn(loaded, unloaded):
    """Targets, joint angles, owners and loads; the first targets have no load."""
    rng = np.random.default_rng(4)
    q = np.array([0.3, 0.5, 0.3, 0.2, -0.8, 0.1]) + rng.uniform(-0.2, 0.2, (N, 6))
    owner = np.repeat(np.arange(N), EACH)
    wrench = rng.normal(size=(N * EACH, 6)) * np.array([60.0] * 3 + [5.0] * 3)
    wrench[owner < unloaded] = 0.0
    direction = rng.choice([-1.0, 1.0], (N * EACH, 6))
    spread = 0.1 * np.abs(wrench)[:, :, None] * np.eye(6)
    loads = Loads(wrench, direction, spread, rng.random(N * EACH) < 0.5, np.full(N * EACH, "hinge_oblong"))
    return loaded.kinematics.forward(q) @ loaded.T_flange_tool, q, owner, loads


@pytest.mark.parametrize("turned", [range(0, 3), range(3, 9), range(0, N * EACH, 7)])
def test_only_what_has_changed_is_corrected_anew(loaded, turned):
    """The first three loads that turn have no force at all: a share of the largest force of none is no number."""
    T, q, owner, before = drawn(loaded, unloaded=2)
    direction = before.direction.copy()
    direction[list(turned)] *= -1.0
    after = Loads(before.wrench, direction, before.spread, before.bounded, before.kind)
    changed = (direction != before.direction).any(axis=1)
    found = loaded.corrected_for_all(T, q, owner, before)
    again = loaded.corrected_again(found, T, q, owner, after, changed)
    anew = loaded.corrected_for_all(T, q, owner, after)
    for name in ("T_base_tool", "q", "deflection", "residual"):
        np.testing.assert_allclose(getattr(again, name), getattr(anew, name), atol=1e-12)
    if max(turned) > EACH * 2:
        assert np.abs(again.T_base_tool - found.T_base_tool).max() > 1e-6
