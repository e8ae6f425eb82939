"""Which weights a cell's file puts into the model, and what it may not say."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from doormill_ros.cell.errors import BadCellFile
from doormill_ros.cell.places.gravity import Gravity, ToolLoad
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.correction.gravity import weights_of, with_gravity
from doormill_ros.pipeline.plan import load_setup
from doormill_ros.resources import resource
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.causes.registry import build_cause
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel, SizedCause, load_model_of
from doormill_ros.robot_model.gravity.model import SaggingModel
from doormill_ros.robot_model.pose.compliance import PoseErrorCompliance
from doormill_ros.robot_model.pose.model import PoseModel
from doormill_ros.simulation.truth.robot import TruthRobot

LOAD = ToolLoad(25.0, 1.0, np.array([0.0, 0.0, 0.1]), "test", True)
POINT = np.array([0.0, 0.0, 0.25])
Q = np.radians([[10.0, 30.0, -10.0, 20.0, 50.0, -30.0], [-20.0, 60.0, 20.0, 10.0, -70.0, 5.0]])


@pytest.fixture(scope="module")
def robot():
    return load_robot("irb6600_175_255")


def written(tmp_path, **gravity):
    document = yaml.safe_load(resource("config/cell.yaml").read_text(encoding="utf-8"))
    document["gravity"] = gravity
    path = tmp_path / "cell.yaml"
    path.write_text(yaml.safe_dump(document), encoding="utf-8")
    return load_layout(path)


def test_the_shipped_cell_tells_no_weight(robot):
    model = load_model_of(robot)
    assert with_gravity(model, robot, load_layout().gravity) is model
    assert not isinstance(load_setup().model, SaggingModel)


def test_a_told_load_is_what_the_file_says(robot, tmp_path):
    told = {"mass": 25, "std": 1, "centre": [0, 0, 0.1], "source": "test", "measured": True}
    gravity = written(tmp_path, tool_load=told, taught=[[0, 0.1, 0.2, 0, 0.4, 0]]).gravity
    model = with_gravity(load_model_of(robot), robot, gravity)
    weight = np.array([0.0, 0.0, -25.0 * 9.80665])
    truth = TruthRobot(robot.dh, stiffness=robot.stiffness)
    frames = truth.forward(np.vstack([Q, [[0, 0.1, 0.2, 0, 0.4, 0]]]))
    arm = frames[:, :3, :3] @ (np.array([0.0, 0.0, 0.1]) - POINT)
    wrench = np.concatenate([np.broadcast_to(weight, arm.shape), np.cross(arm, weight)], axis=1)
    bent = truth.deflected(np.vstack([Q, [[0, 0.1, 0.2, 0, 0.4, 0]]]), wrench, POINT)
    moved = (bent - frames)[:, :3, :3] @ POINT + (bent - frames)[:, :3, 3]
    assert np.linalg.norm(moved, axis=1).min() > 2e-4
    np.testing.assert_allclose(model.standing(Q, POINT)[:, :3], moved[:2] - moved[2], atol=2e-6)


def test_a_load_adds_to_what_a_force_does(robot):
    springs = load_model_of(robot)
    model = with_gravity(springs, robot, Gravity(LOAD))
    wrench = np.array([[100.0, -50.0, 20.0, 1.0, 2.0, 3.0]])
    both = model.deflection(Q, np.repeat(wrench, 2, axis=0), POINT)
    alone = springs.deflection(Q, np.repeat(wrench, 2, axis=0), POINT)
    np.testing.assert_allclose(both - alone, model.standing(Q, POINT), atol=1e-18)


def test_springs_that_a_diagnosis_found_soft_sag_more(robot):
    cause = build_cause("joint_stiffness", "joint 2")
    soft = ExtendedComplianceModel(
        robot.name, robot.dh, robot.stiffness, [SizedCause(cause, 0.5 * robot.stiffness[1:2])]
    )
    found = with_gravity(soft, robot, Gravity(LOAD)).standing(Q, POINT)
    springs = np.where(np.arange(6) == 1, 0.5, 1.0) * robot.stiffness
    same = ExtendedComplianceModel(robot.name, robot.dh, springs, ())
    np.testing.assert_allclose(found, with_gravity(same, robot, Gravity(LOAD)).standing(Q, POINT))
    stiff = with_gravity(load_model_of(robot), robot, Gravity(LOAD)).standing(Q, POINT)
    assert np.all(np.abs(found - stiff).max(axis=1) > 5e-5)


def test_poses_of_a_robot_that_sagged_get_no_weight_on_top(robot):
    poses = PoseErrorCompliance(PoseModel(robot.name, robot.dh, (), (), np.zeros(0)), JointSpringModel(robot))
    assert with_gravity(poses, robot, Gravity(LOAD)) is poses


def test_the_balancing_cylinder_takes_its_share_of_the_links_alone(robot):
    (tool,) = weights_of(robot, Gravity(LOAD))
    links = weights_of(robot, Gravity(None, True))
    np.testing.assert_array_equal(tool.carried, np.ones(6))
    assert len(links) == 6
    for weight in links:
        np.testing.assert_allclose(weight.carried, [1.0, 1.0 - robot.links.balanced[1], 1.0, 1.0, 1.0, 1.0])
        assert weight.std > 0.2 * weight.mass > 0.0


def test_a_load_in_grams_is_refused_with_both_figures(robot):
    with pytest.raises(BadCellFile, match=r"25000 kg.*carries 175 kg at most; state kilograms"):
        with_gravity(load_model_of(robot), robot, Gravity(replace(LOAD, mass=25000.0)))


def test_links_that_nobody_weighed_cannot_be_asked_for(robot):
    bare = replace(robot, links=None)
    with pytest.raises(BadCellFile, match=r"nobody stated what the links .* weigh: add links to"):
        with_gravity(load_model_of(robot), bare, Gravity(None, True))


@pytest.mark.parametrize(
    ("gravity", "what"),
    [
        ({"tool_load": {"mass": 25}}, "tool_load"),
        ({"tool_load": {"mass": -1, "std": 1, "centre": [0, 0, 0], "source": "x", "measured": True}}, "mass"),
        ({"taught": [[0, 0, 0]]}, "taught"),
        ({"links": "yes please"}, "links"),
    ],
)
def test_what_is_no_weight_is_named(tmp_path, gravity, what):
    with pytest.raises(BadCellFile, match=f"gravity.*{what}"):
        written(tmp_path, **gravity)
