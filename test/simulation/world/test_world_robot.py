"""The arm of a world against figures computed by hand and by energy."""

import numpy as np
import pytest

from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.simulation.truth.chain import chain
from doormill_ros.simulation.world.robot import WorldRobot, geometry_errors
from doormill_ros.simulation.world.world_file import GeometryErrors, LinksOfWorld, RobotOfWorld, ToolOfWorld

ROBOT = load_robot("irb6600_175_255")
HOME = np.zeros((1, 6))
TIP = np.array([0.0, 0.0, 0.18])  # straight ahead of the axis of joint 1 in the home posture
STIFFNESS_1 = 2.44e6  # of joint 1 [N m / rad], thesis table 4.1 by its test of joint 1
SIDEWAYS = np.array([[0.0, 100.0, 0.0, 0.0, 0.0, 0.0]])
STILL = np.zeros((1, 6))


def yaw(robot, wrench=SIDEWAYS, direction=STILL):
    """Angle by which a load turns the flange about base z."""
    loaded = robot.flange(HOME, wrench, TIP, direction)[0]
    free = robot.flange(HOME, np.zeros((1, 6)), TIP, direction)[0]
    turn = loaded[:3, :3] @ free[:3, :3].T
    return np.arctan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1])


def only_joint_1(**values):
    """A robot whose other joints do not give way."""
    factor = values.pop("factor", 1.0)
    return WorldRobot(ROBOT.dh, RobotOfWorld(stiffness_factor=(factor, *(1e9,) * 5), **values))


LEVER = (Kinematics(ROBOT).forward(HOME)[0, :3, 3] + np.array([0.18, 0.0, 0.0]))[0]


def test_a_spring_of_0_7_times_the_stiffness_gives_way_by_1_over_0_7():
    assert yaw(only_joint_1()) == pytest.approx(100.0 * LEVER / STIFFNESS_1, rel=1e-9)
    assert yaw(only_joint_1(factor=0.7)) == pytest.approx(yaw(only_joint_1()) / 0.7, rel=1e-9)


def test_a_factor_of_another_joint_moves_nothing_of_joint_1():
    soft = RobotOfWorld(stiffness_factor=(1e9, 1e9, 0.7, 1e9, 1e9, 1e9))
    assert abs(yaw(WorldRobot(ROBOT.dh, soft))) < 1e-9 * yaw(only_joint_1())


@pytest.mark.parametrize(
    ("direction", "crossing", "share"),
    [(1, 0.0, 1.0), (-1, 0.0, 0.0), (0, 0.0, 0.0), (1, 2000.0, LEVER / 20.0), (1, 5.0, 1.0)],
)
def test_a_gap_opens_along_the_load_after_a_motion_along_it_up_to_its_crossing(direction, crossing, share):
    gap = 1e-4
    worn = only_joint_1(gap=(gap, 0, 0, 0, 0, 0), crossing=crossing)
    way = np.array([[direction, 0, 0, 0, 0, 0]], dtype=float)
    opened = yaw(worn, direction=way) - yaw(only_joint_1(), direction=way)
    # 100 N at the lever; the whole gap from the crossing on.
    assert opened == pytest.approx(gap * share, abs=1e-12)
    assert yaw(worn, -SIDEWAYS, -way) == pytest.approx(-yaw(worn, direction=way), rel=1e-9)


def test_link_errors_have_the_size_they_say_and_are_those_of_their_seed():
    errors = geometry_errors(GeometryErrors(3, 1e-4))
    lengths, angles = errors[:, 1:3], errors[:, [0, 3]]
    assert np.sqrt(np.mean(lengths**2)) == pytest.approx(1e-4)
    assert np.sqrt(np.mean(angles**2)) == pytest.approx(1e-4)
    np.testing.assert_array_equal(errors, geometry_errors(GeometryErrors(3, 1e-4)))
    assert not np.allclose(errors, geometry_errors(GeometryErrors(4, 1e-4)))
    np.testing.assert_allclose(geometry_errors(GeometryErrors(3, 2e-4)), 2.0 * errors)
    assert not geometry_errors(GeometryErrors(3, 0.0)).any()
    wrong = WorldRobot(ROBOT.dh, RobotOfWorld(pose_error=GeometryErrors(3, 1e-4)))
    np.testing.assert_array_equal(wrong.dh, ROBOT.dh + errors)


POSTURES = np.random.default_rng(5).uniform(-1.2, 1.2, (6, 6))


@pytest.mark.parametrize(
    ("tool", "links"),
    [
        (ToolOfWorld(mass=25.0, com=np.array([0.02, -0.01, 0.12])), LinksOfWorld()),
        (ToolOfWorld(), LinksOfWorld((300.0, 250.0, 150.0, 60.0, 30.0, 5.0))),
        (ToolOfWorld(), LinksOfWorld((0.0, 250.0))),
    ],
)
def test_the_torques_of_the_weight_are_the_slope_of_its_energy(tool, links):
    """Principle of virtual work: torque = - dV/dq."""
    robot = WorldRobot(ROBOT.dh, RobotOfWorld(), tool, links)

    def energy(q):
        frames = chain(ROBOT.dh, q)
        height = tool.mass * (frames[:, 6] @ np.append(tool.com, 1.0))[:, 2]
        for k, mass in enumerate(links.masses):
            height = height + mass * 0.5 * (frames[:, k, 2, 3] + frames[:, k + 1, 2, 3])
        return 9.80665 * height

    found = robot.torques(chain(ROBOT.dh, POSTURES), np.zeros((len(POSTURES), 6)), TIP)
    step = 1e-5
    for k in range(6):
        turn = np.zeros(6)
        turn[k] = step
        slope = (energy(POSTURES + turn) - energy(POSTURES - turn)) / (2.0 * step)
        np.testing.assert_allclose(found[:, k], -slope, atol=1e-4)


def test_a_tool_of_25_kg_straight_ahead_sags_by_its_weight_times_the_square_of_its_lever_over_the_spring():
    stiff = RobotOfWorld(stiffness_factor=(1e9, 1.0, 1e9, 1e9, 1e9, 1e9))
    tool = ToolOfWorld(mass=25.0, com=np.array([0.0, 0.0, 0.12]))
    free, heavy = (
        WorldRobot(ROBOT.dh, stiff, one).flange(HOME, np.zeros((1, 6)), TIP, STILL)[0] for one in (None, tool)
    )
    # Joint 2 stands 0.32 m ahead of the base; its spring is 0.887 times that of joint 1.
    lever = free[0, 3] - 0.32
    angle = 25.0 * 9.80665 * (lever + 0.12) / (0.887 * STIFFNESS_1)
    assert heavy[2, 3] - free[2, 3] == pytest.approx(-angle * lever, rel=1e-3)
    assert heavy[1, 3] == pytest.approx(free[1, 3], abs=1e-12)


def test_an_arm_without_masses_and_load_stands_where_the_published_geometry_has_it():
    direction = np.ones_like(POSTURES)
    worn = WorldRobot(ROBOT.dh, RobotOfWorld(stiffness_factor=(0.5,) * 6, gap=(1e-3,) * 6))
    found = worn.flange(POSTURES, np.zeros((len(POSTURES), 6)), TIP, direction)
    np.testing.assert_allclose(found, Kinematics(ROBOT).forward(POSTURES), atol=1e-12)
