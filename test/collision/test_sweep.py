"""What is proven free is free wherever one looks, and what is in the way is found however short it is met."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.collision.joint_way import joint_way
from doormill_ros.collision.sweep import RESERVE, Contact, contact_along, contact_at, contact_on_line
from doormill_ros.collision.world import Mill, PlacedDoor, World
from doormill_ros.frames import transform
from doormill_ros.robot.bodies import Body
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.inverse import inverse_near
from doormill_ros.robot.kinematics import Kinematics

LAYOUT, ROBOT = load_layout(), load_robot("irb6600_175_255")
SIZE = np.array([0.04, 0.825, 2.04])
FACE = LAYOUT.rear_face_x - SIZE[0]
R_FACING = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
TURN = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
UP = np.array([0.0, 0.0, 0.05])


@pytest.fixture(scope="module")
def world():
    return World(ROBOT, LAYOUT, Mill(0.12, 0.01), PlacedDoor(SIZE, LAYOUT.T_base_door(0.825, 0.04)))


def near_the_door(rng, n):
    """Postures with the tip somewhere before, beside or in the door."""
    places = rng.uniform([1.3, -0.4, -0.1], [2.0, 1.2, 2.0], (n, 3))
    poses = np.tile(transform(R_FACING, np.zeros(3)), (n, 1, 1))
    poses[:, :3, 3] = places
    q = inverse_near(
        ROBOT, poses @ np.linalg.inv(LAYOUT.T_flange_tool), np.array([0.3, 0.5, 0.3, 0.0, -0.8, 0.0])
    )
    return q[~np.isnan(q).any(axis=1)]


def test_a_verdict_agrees_with_many_samples(world):
    rng = np.random.default_rng(5)
    free = touched = 0
    for start, end in itertools.pairwise(near_the_door(rng, 60)):
        dense = start + np.linspace(0.0, 1.0, 400)[:, None] * (end - start)
        lowest = min(world.distances(q).min() for q in dense)
        found = contact_along(world, np.array([start, end]))
        if found is None:
            free += 1
            assert lowest >= world.clearance
        else:
            touched += 1
            # Whatever was found really is so near, and the samples come as near, but for the way between two of them.
            pair = world.names.index((found.body, found.obstacle))
            assert world.distances(found.q)[pair] == pytest.approx(found.distance)
            assert found.distance < world.clearance + RESERVE
            assert lowest < world.clearance + RESERVE + 0.02
    assert free > 5
    assert touched > 5


def test_a_thin_thing_met_for_a_moment_is_found():
    """A wire of 1 mm across a turn of 2 rad: no even sampling of a hundred postures meets it."""
    start, end = LAYOUT.home - TURN, LAYOUT.home + TURN
    tip = (Kinematics(ROBOT).forward(0.37 * start + 0.63 * end) @ LAYOUT.T_flange_tool)[:3, 3]
    wire = Body("wire", "capsule", radius=0.0005, start=tip + UP, end=tip - UP)
    w = World(ROBOT, replace(LAYOUT, obstacles=(wire,)), Mill(0.12, 0.01), None)
    found = contact_along(w, np.array([start, end]))
    assert (found.body, found.obstacle) == ("mill", "wire")
    assert contact_along(w, np.array([start, 0.6 * start + 0.4 * end])) is None


def line(start, end, n):
    places = start + np.linspace(0.0, 1.0, n)[:, None] * (end - start)
    poses = np.tile(transform(R_FACING, np.zeros(3)), (n, 1, 1))
    poses[:, :3, 3] = places
    return inverse_near(
        ROBOT, poses @ np.linalg.inv(LAYOUT.T_flange_tool), np.array([0.3, 0.5, 0.3, 0.0, -0.8, 0.0])
    )


@pytest.mark.parametrize(("distance", "free"), [(0.030, True), (0.0225, True), (0.0215, False), (0.0, False)])
def test_a_tool_that_goes_along_the_face_is_judged_by_its_distance(world, distance, free):
    x = FACE - distance
    q = line(np.array([x, 0.1, 0.5]), np.array([x, 0.1, 1.3]), 33)
    found = contact_on_line(world, q, np.linspace(0.0, 1.0, 33))
    assert (found is None) is free
    if not free:
        assert (found.body, found.obstacle) == ("mill", "door")
        assert found.distance == pytest.approx(distance - 0.01, abs=1e-3)


def test_a_straight_way_past_a_corner_is_judged_where_it_passes(world):
    """Both ends are clear of the door, the middle is not."""
    q = line(np.array([FACE - 0.06, -0.35, 0.9]), np.array([FACE + 0.04, 0.0, 0.9]), 33)
    found = contact_on_line(world, q, np.linspace(0.0, 1.0, 33))
    assert found is not None
    assert found.obstacle == "door"


def test_a_way_round_the_edge_is_found_and_is_free(world):
    """From before the face to behind the hinge edge, where the straight way leads through the wood."""
    start = line(np.array([1.7, 0.2, 0.9]), np.array([1.6, 0.2, 0.9]), 2)[0]
    end = line(np.array([FACE + 0.02, -0.12, 0.9]), np.array([1.6, -0.2, 0.9]), 2)[0]
    assert contact_at(world, start) is None
    assert contact_at(world, end) is None
    straight = joint_way(world, start, end)
    assert isinstance(straight, Contact)
    way = joint_way(world, start, end, limits=(ROBOT.lower, ROBOT.upper))
    assert isinstance(way, list)
    assert way
    again = joint_way(world, start, end, limits=(ROBOT.lower, ROBOT.upper))
    np.testing.assert_array_equal(way, again)
    passed = [start, *way, end]
    for a, b in itertools.pairwise(passed):
        dense = a + np.linspace(0.0, 1.0, 100)[:, None] * (b - a)
        assert min(world.distances(q).min() for q in dense) >= world.clearance
