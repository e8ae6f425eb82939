"""What circles and lines between targets are, against circles that were drawn first."""

import itertools

import numpy as np
import pytest

from doormill_ros.robot.configuration import ConfData
from doormill_ros.toolpath.curves.arcs import circles
from doormill_ros.toolpath.curves.motion_ways import motion_ways, tool_at_points
from doormill_ros.toolpath.pacing.timing import motion_times
from doormill_ros.toolpath.program import MillingProgram, Motion, MotionKind, Target
from doormill_ros.toolpath.settings import load_settings


@pytest.fixture(scope="module")
def standard(cell):
    recipe = cell.recipe("standard_door")
    return recipe, cell.robot, cell.program(recipe, cell.placed(recipe))


def test_circles_are_those_that_their_points_were_taken_from():
    rng = np.random.default_rng(0)
    turned, radius = rng.uniform(0.05, 4.1, 500), 10.0 ** rng.uniform(-3.0, 1.0, 500)
    middle = turned * rng.uniform(0.3, 0.7, 500)  # neither chord spans half of the circle
    frames = np.linalg.qr(rng.normal(size=(500, 3, 3)))[0]
    centre = rng.normal(size=(500, 3))

    def at(angle):
        return centre + radius[:, None] * along(angle)

    def along(angle):
        return np.cos(angle)[:, None] * frames[..., 0] + np.sin(angle)[:, None] * frames[..., 1]

    length, found, begin, end = circles(at(0.0 * turned), at(middle), at(turned))
    np.testing.assert_allclose(length, radius * turned, rtol=1e-6)
    np.testing.assert_allclose(found, radius, rtol=1e-6)
    np.testing.assert_allclose(begin, along(0.0 * turned + 0.5 * np.pi), atol=1e-6)
    np.testing.assert_allclose(end, along(turned + 0.5 * np.pi), atol=1e-6)


def test_three_points_on_a_line_are_no_circle():
    start, end = np.zeros((2, 3)), np.array([[0.1, 0.0, 0.0], [0.0, 0.0, 0.0]])
    length, radius, begin, finish = circles(start, 0.5 * (start + end), end)
    np.testing.assert_allclose(length, [0.1, 0.0])
    assert np.all(np.isinf(radius))
    np.testing.assert_allclose(begin, [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    np.testing.assert_array_equal(begin, finish)


def test_nothing_is_told_of_ways_that_the_joints_make():
    places = np.array([[0.0, 0.0, 0.0], [0.3, 0.4, 0.0], [0.3, 0.4, 0.1], [0.1, 0.2, 0.2], [0.2, 0.2, 0.2]])
    targets = tuple(
        Target(str(i), T, T, np.zeros(6), ConfData(0, 0, 0, 0), np.zeros(6), np.zeros(6))
        for i, T in enumerate(np.tile(np.eye(4), (len(places), 1, 1)))
    )
    kinds = [
        (MotionKind.LINEAR, 0, None),
        (MotionKind.LINEAR, 1, None),
        (MotionKind.CIRCULAR, 3, 2),
        (MotionKind.JOINT, 0, None),
        (MotionKind.LINEAR, 4, None),
        (MotionKind.ABSOLUTE, 0, None),
        (MotionKind.LINEAR, 1, None),
    ]
    motions = tuple(Motion(kind, target, via, 0.1, "fine", "a", True) for kind, target, via in kinds)
    ways = motion_ways(MillingProgram("d", 1, targets, motions, (np.zeros(6),)), places)
    assert ways.known.tolist() == [False, True, True, False, True, False, False]
    (arc,), (radius,), (begin,), (end,) = circles(places[[1]], places[[2]], places[[3]])
    np.testing.assert_allclose(ways.length, [0.0, 0.5, arc, 0.0, np.sqrt(0.12), 0.0, 0.0])
    assert ways.radius.tolist() == pytest.approx([np.inf, np.inf, radius, *[np.inf] * 4])
    np.testing.assert_allclose(ways.begin[1], [0.6, 0.8, 0.0])
    np.testing.assert_allclose([ways.begin[2], ways.end[2]], [begin, end])


def test_a_line_from_a_point_of_joint_space_is_as_long_as_from_where_the_tool_stands_there(standard):
    _, robot, program = standard
    stands = tool_at_points(program, robot)
    follows = [
        (before, i)
        for i, (before, motion) in enumerate(itertools.pairwise(program.motions), start=1)
        if before.kind is MotionKind.ABSOLUTE and motion.kind is MotionKind.LINEAR
    ]
    assert follows
    places = np.array([target.T_base_tool_nominal[:3, 3] for target in program.targets])
    ways = motion_ways(program, places, stands)
    bare = motion_ways(program, places)
    for before, i in follows:
        way = places[program.motions[i].target] - stands[before.target]
        assert ways.known[i]
        assert not bare.known[i]
        assert ways.length[i] == pytest.approx(np.linalg.norm(way))
        np.testing.assert_allclose(ways.begin[i], way / np.linalg.norm(way), atol=1e-9)
    rest = np.setdiff1d(np.arange(len(program.motions)), [i for _, i in follows])
    np.testing.assert_array_equal(ways.length[rest], bare.length[rest])


def test_a_door_takes_the_time_of_the_lines_behind_its_ways(standard):
    """They are the ways to the wood, at their speed no quicker than so."""
    _, robot, program = standard
    stands = tool_at_points(program, robot)
    times = motion_times(program, robot, load_settings().cycle)
    found, least = [], []
    for i, (before, motion) in enumerate(itertools.pairwise(program.motions), start=1):
        if before.kind is MotionKind.ABSOLUTE and motion.kind is MotionKind.LINEAR:
            end = program.targets[motion.target].T_base_tool_nominal[:3, 3]
            least.append(np.linalg.norm(end - stands[before.target]) / motion.speed)
            found.append(times[i])
    assert found
    assert np.all(np.array(found) > least)
