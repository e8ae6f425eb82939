"""Distances between bodies against distances known beforehand, and how far joints can move a body."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.collision.world import DOOR, MILL, Mill, PlacedDoor, World
from doormill_ros.frames import rotation_x, transform
from doormill_ros.recipes.door import WIDTH_MM
from doormill_ros.robot.bodies import Body, load_bodies
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot.urdf import link_poses
from support.inverse_kinematics import inverse

SIZE = np.array([0.04, 0.825, 2.04])
LAYOUT, ROBOT = load_layout(), load_robot("irb6600_175_255")
R_FACING = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # tool along base x


def world(T_base_door, mill=None):
    return World(ROBOT, LAYOUT, mill or Mill(0.12, 0.01), PlacedDoor(SIZE, T_base_door))


def gap(w, q, body, obstacle):
    return w.distances(q)[w.names.index((body, obstacle))]


def posture(T_base_tool):
    return inverse(ROBOT, T_base_tool @ np.linalg.inv(LAYOUT.T_flange_tool))[0]


@pytest.mark.parametrize("width", [min(WIDTH_MM) / 1e3, 0.825, max(WIDTH_MM) / 1e3])
@pytest.mark.parametrize("turn", [-1.0, 1.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_no_door_within_the_limits_of_placement_stands_in_the_sill(width, turn, side):
    (sill,) = (body for body in LAYOUT.obstacles if body.name == "clamp sill")
    limits = LAYOUT.limits
    placed = DoorOffset(side * limits.y, -limits.z, turn * limits.rotation)
    T_base_door = LAYOUT.T_base_door(width, 0.04, placed)
    y = sill.position[1] + np.array([-0.5, 0.5]) * sill.size[1]
    lowest = T_base_door[2, 3] + (y - T_base_door[1, 3]) * np.tan(placed.rotation)
    assert lowest.min() > sill.position[2] + sill.size[2] / 2.0


@pytest.mark.parametrize("distance", [0.03, 0.10, 0.011])
def test_straight_in_front_of_the_face_the_tip_is_nearest(distance):
    T_base_door = transform(rotation_x(0.02), np.array([1.86, -0.03, -0.15]))
    inside = T_base_door @ np.array([-distance, 0.4, 1.0, 1.0])
    w = world(T_base_door)
    q = posture(transform(R_FACING, inside[:3]))
    assert gap(w, q, MILL, DOOR) == pytest.approx(distance - 0.010, abs=1e-6)
    assert gap(w, q, "spindle", DOOR) == pytest.approx(distance + 0.12, abs=1e-6)


def test_a_mill_in_the_wood_is_as_deep_as_it_is():
    T_base_door = transform(np.eye(3), np.array([1.86, -0.03, -0.15]))
    q = posture(transform(R_FACING, np.array([1.87, 0.37, 0.85])))
    assert gap(world(T_base_door), q, MILL, DOOR) == pytest.approx(-0.020, abs=1e-4)


def test_a_door_far_away_hides_no_obstacle():
    q = posture(transform(R_FACING, np.array([1.6, 0.385, 0.3])))
    w = world(transform(np.eye(3), np.array([5.0, 0.0, 0.0])))
    # The floor's upper side is at -0.5; 12 cm of spindle are 6 cm thick on the lower side.
    assert gap(w, q, "spindle", "floor") == pytest.approx(0.3 - 0.06 + 0.5, abs=1e-6)


@pytest.mark.parametrize("name", ["irb6600_175_255", "irb6700_235_265"])
def test_no_body_moves_further_than_its_reach_says(name):
    """Each body's corners, moved by each joint alone in hundreds of postures."""
    robot = load_robot(name)
    w = World(robot, LAYOUT, Mill(0.12, 0.01), PlacedDoor(SIZE, np.eye(4)))
    kinematics = Kinematics(robot)
    frames = {body.link: 0 for body in load_bodies(robot)}
    frames = {link: int(link[-1]) if link[-1].isdigit() else 0 for link in frames}
    rng = np.random.default_rng(3)
    q = rng.uniform(robot.lower, robot.upper, (300, 6))
    zero = kinematics.link_frames(np.zeros(6))
    largest = 0.0
    for body in load_bodies(robot):
        link = frames[body.link]
        if not link:
            continue
        # The URDF's link frames are parallel to the base with all angles zero, origins on the axes.
        T_base_link = transform(np.eye(3), link_origin(robot, link))
        corners = np.c_[body.corners, np.ones(len(body.corners))] @ T_base_link.T
        local = corners @ np.linalg.inv(zero[link]).T  # (corners, 4) in the Denavit-Hartenberg frame
        row = w.reach[w.names.index((body.name, DOOR))]
        for point in local:
            J = kinematics.link_jacobian(q, link, point[:3])[:, :3]  # (n, 3, 6)
            speed = np.linalg.norm(J, axis=1)  # (n, 6)
            assert np.all(speed <= row + body.margin + 1e-9)
            largest = max(largest, float((speed / np.maximum(row, 1e-9)).max()))
    assert largest > 0.9  # the bound is not idle


def link_origin(robot, link):
    T = np.eye(4)
    for pose in link_poses(robot.urdf, np.zeros(6)):
        T = T @ pose.T_parent_child
        if pose.child == f"link_{link}":
            return T[:3, 3]
    raise AssertionError(link)


def test_a_capsule_is_as_wide_all_round_as_it_is():
    post = Body(
        "post", "capsule", radius=0.1, start=np.array([1.9, 0.4, -1.0]), end=np.array([1.9, 0.4, 2.0])
    )
    layout = replace(LAYOUT, obstacles=(post,))
    w = World(ROBOT, layout, Mill(0.12, 0.01), None)
    q = posture(transform(R_FACING, np.array([1.7, 0.4, 0.8])))
    assert gap(w, q, MILL, "post") == pytest.approx(0.2 - 0.1 - 0.01, abs=1e-6)


def test_what_is_no_pair_is_never_near():
    """Pairs that are left out, in hundreds of postures, against a world that leaves none out."""
    T_base_door = transform(np.eye(3), np.array([1.86, -0.03, -0.15]))
    near = world(T_base_door)
    every = World(ROBOT, replace(LAYOUT, clearance=10.0), Mill(0.12, 0.01), PlacedDoor(SIZE, T_base_door))
    out = np.array([number for number, pair in enumerate(every.names) if pair not in near.names])
    assert len(out) > 20
    assert len(every.names) == len(near.names) + len(out)
    postures = np.random.default_rng(5).uniform(ROBOT.lower, ROBOT.upper, (300, 6))
    least = min(every.distances(q, out).min() for q in postures)
    assert least > LAYOUT.clearance
