"""What doors measured of force, springs and gaps, against drawn ones, in the spread of a correction."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.correction.felt import felt
from doormill_ros.correction.loaded_robot import LoadedRobot
from doormill_ros.correction.loads import Loads
from doormill_ros.correction.worth import worth_of
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.causes.registry import build_cause
from doormill_ros.robot_model.elastic.knowledge import MeasuredForce
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel, SizedCause, load_model_of

ROBOT, TOOL = load_robot("irb6600_175_255"), load_layout().T_flange_tool
Q = np.radians([[-13.58, 69.54, 34.97, -14.01, -104.10, -93.48]])
WRENCH = np.array([12.0, 209.0, 29.0, 1.0, -3.0, 2.0])
FORCE = MeasuredForce(("hinge_oblong",), 0.02, 0.05)
LARGER = SizedCause(build_cause("process_force", "tool"), np.array([1.3]), np.array([0.02]))
TURNED = SizedCause(build_cause("process_force_direction", "tool"), np.array([0.4]), np.array([0.05]))


def loads(kind="hinge_oblong", bounded=False, std=(90.0, 20.0, 0.0, 0.0, 0.0, 0.0)):
    R = (Kinematics(ROBOT).forward(Q) @ TOOL)[0, :3, :3]
    axes = np.zeros((6, 6))
    axes[:3, :3], axes[3:, 3:] = R.T, R.T
    spread = np.array(std)[:, None] * axes
    return Loads(WRENCH[None], np.zeros((1, 6)), spread[None], np.array([bounded]), np.array([kind]))


def model(causes=(LARGER, TURNED), force=FORCE):
    return ExtendedComplianceModel(ROBOT.name, ROBOT.dh, ROBOT.stiffness, causes, (), force)


def spread(model, of):
    loaded = LoadedRobot(Kinematics(ROBOT), model, TOOL)
    return loaded.spread(worth_of(ROBOT, 4e-5, model), Q, of)


def moved(wrench, stiffness, gaps=(0.0,) * 6):
    """Displacement of the tool, each joint by itself with its spring and its gap."""
    J = Kinematics(ROBOT).jacobian(Q, TOOL[:3, 3])[0]
    return sum(J[:3, k] * (J[:, k] @ wrench / stiffness[k] + gaps[k]) for k in range(6))


def acting(factor, angle):
    """The wrench, larger and turned about the tool."""
    axis = (Kinematics(ROBOT).forward(Q) @ TOOL)[0, :3, 2]
    turn = Rotation.from_rotvec(angle * axis)
    return factor * np.concatenate([turn.apply(WRENCH[:3]), turn.apply(WRENCH[3:])])


def test_a_measured_force_leaves_what_drawn_sizes_and_directions_leave():
    rng, small = np.random.default_rng(1), 0.1  # first order: the tenth of every deviation
    drawn = [
        moved(
            acting(1.3 + small * 0.02 * rng.normal(), 0.4 + small * 0.05 * rng.normal()),
            ROBOT.stiffness,
        )
        for _ in range(4000)
    ]
    off = np.array(drawn) - moved(acting(1.3, 0.4), ROBOT.stiffness)
    expected = np.sqrt(np.mean(np.sum(off**2, axis=1))) / small
    assert spread(model(), loads()).force[0] == pytest.approx(expected, rel=0.05)


def test_springs_are_in_doubt_under_the_force_that_acts():
    drawn = []
    rng, small = np.random.default_rng(2), 0.1
    share = ROBOT.stiffness_std / ROBOT.stiffness
    for _ in range(4000):
        drawn.append(moved(acting(1.3, 0.4), ROBOT.stiffness * (1.0 + small * share * rng.normal(size=6))))
    off = np.array(drawn) - moved(acting(1.3, 0.4), ROBOT.stiffness)
    expected = np.sqrt(np.mean(np.sum(off**2, axis=1))) / small
    assert np.linalg.norm(spread(model(), loads()).joints[0]) == pytest.approx(expected, rel=0.05)


def test_springs_and_gaps_that_were_measured_have_the_spread_of_their_measurement():
    spring = SizedCause(build_cause("joint_stiffness", "joint 3"), np.array([1.1e6]), np.array([2e4]))
    gap = SizedCause(build_cause("joint_backlash", "joint 1"), np.array([1e-4, 0.0]), np.array([3e-6, 0.0]))
    known = model((spring, gap), None)
    soft = ROBOT.stiffness.copy()
    soft[2] = 1.1e6
    std = ROBOT.stiffness_std.copy()
    std[2] = 2e4
    rng, small = np.random.default_rng(3), 0.1
    drawn = [
        moved(
            WRENCH,
            soft + small * std * rng.normal(size=6),
            small * 3e-6 * rng.normal(size=1).repeat(6) * np.eye(6)[0],
        )
        for _ in range(4000)
    ]
    off = np.array(drawn) - moved(WRENCH, soft)
    expected = np.sqrt(np.mean(np.sum(off**2, axis=1))) / small
    assert np.linalg.norm(spread(known, loads()).joints[0]) == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize(
    "of", [loads(kind="lock_case"), loads(bounded=True)], ids=["other kind", "unmeasured"]
)
def test_a_force_that_the_doors_did_not_show_keeps_the_doubt_of_its_recipe(of):
    assert spread(model(), of).force == pytest.approx(spread(load_model_of(ROBOT), of).force)
    assert spread(model(), of).force[0] > 2.0 * spread(model(), loads()).force[0]


def test_what_walls_hardly_tell_keeps_the_doubt_of_its_recipe():
    of = loads(std=(0.0, 0.0, 19.0, 1.0, 5.0, 2.0))
    none = replace(FORCE, factor_std=0.0, angle_std=0.0)
    assert spread(model(force=none), of).force == pytest.approx(spread(load_model_of(ROBOT), of).force)


def test_a_model_that_names_no_force_changes_no_load():
    of = loads()
    same = felt(load_model_of(ROBOT), of, Q, lambda q: np.array([[0.0, 0.0, 1.0]]))
    np.testing.assert_array_equal(same.wrench, of.wrench)
    np.testing.assert_array_equal(same.spread, of.spread)
