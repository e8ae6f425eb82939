"""What a plane between two bodies promises of the postures about one, against their distances there."""

import itertools

import numpy as np
import pytest

from doormill_ros.cell.layout import load_layout
from doormill_ros.collision.sweep import RESERVE, contact_along
from doormill_ros.collision.world import DOOR, MILL, Mill, PlacedDoor, World
from doormill_ros.frames import transform
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.inverse import inverse_near

LAYOUT, ROBOT = load_layout(), load_robot("irb6600_175_255")
SIZE = np.array([0.04, 0.825, 2.04])
FACE = LAYOUT.rear_face_x - SIZE[0]
R_FACING = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
GJK = 1e-5  #: how exactly the library knows small distances [m]


@pytest.fixture
def world():
    return World(ROBOT, LAYOUT, Mill(0.12, 0.01), PlacedDoor(SIZE, LAYOUT.T_base_door(0.825, 0.04)))


def facing(*places):
    """Postures with the tip there and the tool square to the door's face."""
    poses = np.tile(transform(R_FACING, np.zeros(3)), (len(places), 1, 1))
    poses[:, :3, 3] = places
    return inverse_near(
        ROBOT, poses @ np.linalg.inv(LAYOUT.T_flange_tool), np.array([0.3, 0.5, 0.3, 0.0, -0.8, 0.0])
    )


def test_no_pair_comes_closer_than_promised(world):
    rng = np.random.default_rng(1)
    lower, upper = np.maximum(ROBOT.lower, -2.0), np.minimum(ROBOT.upper, 2.0)
    told = 0
    for _ in range(60):
        q = rng.uniform(lower, upper)
        pairs = np.flatnonzero(world.distances(q) > 0.012)
        distance = world.distances(q, pairs)
        np.testing.assert_allclose(world.lowest(pairs, distance, np.zeros((1, 6)))[0], distance, atol=GJK)
        step = rng.uniform(-1.0, 1.0, (8, 6)) * rng.uniform(0.0, 0.4, (8, 1))
        off = rng.uniform(0.0, 0.03, (8, 6))
        promised = world.lowest(pairs, distance, step, off)
        beside = step + rng.choice([-1.0, 1.0], off.shape) * off
        found = np.array([world.distances(q + s, pairs) for s in beside])
        # Of overlapping bodies the depth is what the library makes of it.
        assert np.all((promised <= found + GJK) | (promised < 0.0))
        told += int((promised > 0.0).sum())
    assert told > 10_000


def test_a_tool_that_draws_back_is_clear_over_a_long_way(world):
    """From 12.5 mm before the face by 20 cm: the joints turn so far that their reach alone would tell nothing."""
    near, far = facing([FACE - 0.0225, 0.2, 0.9], [FACE - 0.2225, 0.2, 0.9])
    pair = np.array([world.names.index((MILL, DOOR))])
    distance = world.distances(near, pair)
    assert np.abs(far - near) @ world.reach[pair[0]] > 20.0 * distance[0]
    step = np.linspace(0.0, 1.0, 6)[1:, None] * (far - near)
    promised = world.lowest(pair, distance, step)[:, 0]
    assert np.all(promised[:3] > distance)


def test_a_verdict_does_not_hang_on_where_it_is_looked(world):
    """Ways that pass closest somewhere between: free up to what they keep there, and not beyond."""
    rng = np.random.default_rng(7)
    ends = facing(*rng.uniform([FACE - 0.3, 0.0, 0.3], [FACE - 0.05, 0.6, 1.6], (9, 3)))
    verdicts = []
    for start, end in itertools.pairwise(ends):
        for bow in (0.0, 0.04):
            middle = 0.5 * (start + end) + bow * np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
            q = np.array([start, middle, end])
            share = np.linspace(0.0, 1.0, 400)[:, None]
            dense = np.concatenate([a + share * (b - a) for a, b in itertools.pairwise(q)])
            lowest = min(world.distances(posture).min() for posture in dense)
            for spare in (5e-5, -5e-5):
                world.clearance = lowest - RESERVE - spare
                verdicts.append(contact_along(world, q) is None)
    assert verdicts == [True, False] * 16


def test_no_plane_is_missed_where_reach_alone_does_not_tell_enough(world):
    """What is told of few pairs for a distance that is enough, against the bounds of all: the same below it."""
    rng = np.random.default_rng(3)
    lower, upper = np.maximum(ROBOT.lower, -2.0), np.minimum(ROBOT.upper, 2.0)
    enough = world.clearance + RESERVE
    below = far = 0
    for _ in range(200):
        q = rng.uniform(lower, upper)
        pairs = np.flatnonzero(world.distances(q) > enough)
        distance = world.distances(q, pairs)
        step = rng.uniform(-1.0, 1.0, (5, 6)) * rng.uniform(0.0, 0.4)
        off = rng.uniform(0.0, 0.03, (5, 6)) if rng.random() < 0.5 else None
        full, told = (world.lowest(pairs, distance, step, off, least) for least in (np.inf, enough))
        np.testing.assert_array_equal(told.min(axis=0) < enough, full.min(axis=0) < enough)
        np.testing.assert_allclose(told[full < enough], full[full < enough], rtol=0.0, atol=1e-12)
        assert np.all((told <= full + 1e-12) & (told >= np.minimum(full, enough) - 1e-12))
        below += int((full < enough).sum())
        far += int((told < full - 1e-6).sum())
    assert below > 1000
    assert far > 1000
