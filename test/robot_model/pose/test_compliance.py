"""A pose diagnosis as the robot model of the path generator."""

import numpy as np
import pytest
import yaml

from doormill_ros.correction.compensate import compensate
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.robot_model.errors import PoseModelError
from doormill_ros.robot_model.extended_model import load_compliance_model
from doormill_ros.robot_model.pose.causes.joint_backlash import PoseBacklash
from doormill_ros.robot_model.pose.causes.joint_periodic_error import JointPeriodicError
from doormill_ros.robot_model.pose.causes.link_geometry import LinkGeometry
from doormill_ros.robot_model.pose.compliance import PoseErrorCompliance
from doormill_ros.robot_model.pose.model import PoseModel, model_document
from doormill_ros.simulation.truth.robot import TruthRobot

ROBOT = "irb6600_175_255"
POINT = np.array([0.0, 0.0, 0.25])
LONGER, PERIODIC, GAP = 6e-4, 1e-4, 3e-4
NO_LOAD = np.zeros((6, 6))


@pytest.fixture
def robot():
    return load_robot(ROBOT)


@pytest.fixture
def model_file(robot, tmp_path):
    """Link 2 is too long, joint 3 wanders twice a turn, joint 1 has play."""
    causes = (LinkGeometry("link 2", robot.dh), JointPeriodicError("joint 3", [2]), PoseBacklash("joint 1"))
    x = np.zeros(4 + 2 + 1)
    x[list(causes[0].names).index("a")] = LONGER
    x[4], x[6] = PERIODIC, GAP
    path = tmp_path / "model.yaml"
    path.write_text(yaml.safe_dump(model_document(PoseModel(ROBOT, robot.dh, (), causes, x), "test")))
    return path


@pytest.fixture
def q():
    return np.random.default_rng(8).uniform(
        [-0.5, 0.0, -0.5, -0.4, 0.4, -1], [0.5, 0.6, 0.3, 0.4, 1.0, 1], (6, 6)
    )


def truth(robot, q, motion=0.0):
    """Where the flange of that robot really stands, by the simulation's own kinematics."""
    dh, turned = np.array(robot.dh), q.copy()
    dh[1, 2] += LONGER
    turned[:, 2] += PERIODIC * np.cos(2.0 * q[:, 2])
    turned[:, 0] += 0.5 * GAP * motion
    return TruthRobot(dh, [], robot.stiffness).forward(turned)


@pytest.mark.parametrize("motion", [-1.0, 0.0, 1.0])
def test_an_unloaded_tool_stands_where_the_true_robot_has_it(robot, model_file, q, motion):
    model = load_compliance_model(model_file)
    assert isinstance(model, PoseErrorCompliance)
    twist = model.deflection(q, NO_LOAD, POINT, np.full((6, 6), motion))
    nominal, actual = Kinematics(robot).forward(q), truth(robot, q, motion)
    point = np.append(POINT, 1.0)
    np.testing.assert_allclose(twist[:, :3], ((actual - nominal) @ point)[:, :3], atol=1e-9)
    assert np.linalg.norm(twist[:, :3], axis=1).min() > 3e-4


def test_a_load_adds_what_the_springs_give(robot, model_file, q):
    model = load_compliance_model(model_file)
    wrench = np.tile([100.0, -200.0, 50.0, 3.0, 0.0, -2.0], (6, 1))
    more = model.deflection(q, wrench, POINT) - model.deflection(q, NO_LOAD, POINT)
    np.testing.assert_allclose(more, JointSpringModel(robot).deflection(q, wrench, POINT), atol=1e-12)


def test_the_corrected_command_brings_the_true_tool_to_its_place(robot, model_file, q):
    model, kinematics = load_compliance_model(model_file), Kinematics(robot)
    T_flange_tool = np.eye(4)
    T_flange_tool[:3, 3] = POINT
    wanted = kinematics.forward(q) @ T_flange_tool
    found = compensate(wanted, q, lambda a: model.deflection(a, NO_LOAD, POINT), kinematics, T_flange_tool)
    before = np.linalg.norm((truth(robot, q) @ T_flange_tool - wanted)[:, :3, 3], axis=1)
    after = np.linalg.norm((truth(robot, found.q) @ T_flange_tool - wanted)[:, :3, 3], axis=1)
    assert before.min() > 3e-4
    assert after.max() < 3e-6  # twice the tolerance of the correction, and what is of second order


def test_a_robot_without_description_is_refused_in_one_sentence(tmp_path, robot):
    model = PoseModel("ur10", robot.dh, (), (), np.zeros(0))
    (tmp_path / "model.yaml").write_text(yaml.safe_dump(model_document(model, "test")))
    with pytest.raises(
        PoseModelError, match=r"unloaded poses of robot 'ur10'.*config/robots/ur10"
    ) as refusal:
        load_compliance_model(tmp_path)
    assert "\n" not in refusal.value.message
