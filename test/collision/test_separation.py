"""What a plane between two bodies promises of the postures about one, against their distances there."""

import itertools

import numpy as np
import pinocchio as pin
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.collision.skeleton import model_of, skeleton_of
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


def told_at(world, q, pairs, distance, here):
    """What a plane and the bodies' reach tell of single postures, shape (n, h)."""
    return world.lowest(pairs, distance, here, world.region(q, np.arange(len(q))[:, None]))


def drawn_within(rng, corners, off, n):
    """Postures somewhere in the hull of some, and beside it, shape (n, 6)."""
    weight = rng.dirichlet(np.full(len(corners), 0.4), n)
    return weight @ corners + rng.choice([-1.0, 0.0, 1.0], (n, 6)) * off


def test_bodies_stand_where_pinocchio_has_them(world):
    rng = np.random.default_rng(2)
    for robot in (ROBOT, load_robot("irb6700_235_265")):
        model = model_of(robot.urdf)
        data = model.createData()
        q = rng.uniform(robot.lower, robot.upper, (50, 6))
        T = skeleton_of(robot.urdf).frames(q)
        for number, posture in enumerate(q):
            pin.forwardKinematics(model, data, posture)
            expected = [data.oMi[joint].homogeneous[:3] for joint in range(7)]
            np.testing.assert_allclose(T[..., number], expected, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("corners", [2, 3, 8])
def test_no_pair_comes_closer_than_promised(world, corners):
    """Of hulls of postures and what lies beside them: no posture drawn there has a pair closer together."""
    rng = np.random.default_rng(corners)
    lower, upper = np.maximum(ROBOT.lower, -2.0), np.minimum(ROBOT.upper, 2.0)
    told = close = 0
    for _ in range(60):
        here = rng.uniform(lower, upper)
        pairs = np.flatnonzero(world.distances(here) > 0.012)
        distance = world.distances(here, pairs)
        np.testing.assert_allclose(
            told_at(world, here[None], pairs, distance, here)[:, 0], distance, atol=GJK
        )
        q = here + rng.uniform(-1.0, 1.0, (4 * corners, 6)) * rng.uniform(0.0, 0.4)
        hulls = rng.permutation(4 * corners).reshape(4, corners)
        off = rng.uniform(0.0, 0.03, (4, 6))
        promised = world.lowest(pairs, distance, here, world.region(q, hulls, off))
        for hull, beside, least in zip(hulls, off, promised.T, strict=True):
            found = np.array([world.distances(p, pairs) for p in drawn_within(rng, q[hull], beside, 12)])
            # Of overlapping bodies the depth is what the library makes of it.
            assert np.all((least <= found + GJK) | (least < 0.0))
            told += int((least > 0.0).sum())
            close += int((found.min(axis=0)[least > 0.0] - least[least > 0.0] < 0.05).sum())
    assert told > 5_000
    assert close > 500  # the bound is not idle


def test_a_plane_tells_the_gap_that_the_corners_have(world):
    """Against the farthest corners of both bodies along the normal, one pair and one posture at a time."""
    rng = np.random.default_rng(4)
    lower, upper = np.maximum(ROBOT.lower, -2.0), np.minimum(ROBOT.upper, 2.0)
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    for _ in range(20):
        here, there = rng.uniform(lower, upper, (2, 6))
        pairs = np.flatnonzero(world.distances(here) > 0.0)
        world.distances(here, pairs)
        assert pairs.size
        normal = world._planes(pairs)
        region = world.region(there[None], np.zeros((1, 1), dtype=int))
        bodies, sides = world._bodies, world._sides[:, pairs]
        gap = bodies.gap(sides, normal, region)[:, 0]
        rough = bodies.rough_gap(sides, normal, region)[:, 0]
        assert np.all(rough <= gap + 1e-9)
        widest = 2.0 * np.linalg.norm(bodies._own[sides[0], :3], axis=(1, 2))
        assert np.all(rough >= gap - widest - 1e-9)
        for pair, own, told in zip(pairs, normal, gap, strict=True):
            moving, other = world._sides[:, pair]
            axis = region.T_base_joint[bodies._joint[other], :, :3, 0] @ own
            places = []
            for body in (moving, other):
                T_base_joint = region.T_base_joint[bodies._joint[body], :, :, 0]
                corners = bodies._own[body, 3] + signs @ bodies._own[body, :3]
                places.append(corners @ T_base_joint[:, :3].T + T_base_joint[:, 3])
            margins = bodies._margin[[moving, other]].sum()
            expected = (places[0] @ axis).min() - (places[1] @ axis).max() - margins
            assert told == pytest.approx(expected, abs=1e-9)


def test_a_tool_that_draws_back_is_clear_over_a_long_way(world):
    """From 12.5 mm before the face by 20 cm: the joints turn so far that their reach alone would tell nothing."""
    near, far = facing([FACE - 0.0225, 0.2, 0.9], [FACE - 0.2225, 0.2, 0.9])
    pair = np.array([world.names.index((MILL, DOOR))])
    distance = world.distances(near, pair)
    assert np.abs(far - near) @ world.reach[pair[0]] > 20.0 * distance[0]
    q = near + np.linspace(0.0, 1.0, 6)[:, None] * (far - near)
    parts = np.arange(5)[:, None] + np.arange(2)
    promised = world.lowest(pair, distance, near, world.region(q, parts))[0]
    assert np.all(promised[0] > distance - 0.002)
    assert np.all(promised[1:] > distance)


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
        ends = q + rng.uniform(-1.0, 1.0, (6, 6)) * rng.uniform(0.0, 0.4)
        off = rng.uniform(0.0, 0.03, (5, 6)) if rng.random() < 0.5 else None
        region = world.region(ends, np.arange(5)[:, None] + np.arange(2), off)
        full, told = (world.lowest(pairs, distance, q, region, least) for least in (np.inf, enough))
        np.testing.assert_array_equal(told.min(axis=1) < enough, full.min(axis=1) < enough)
        np.testing.assert_allclose(told[full < enough], full[full < enough], rtol=0.0, atol=1e-12)
        assert np.all((told <= full + 1e-12) & (told >= np.minimum(full, enough) - 1e-12))
        below += int((full < enough).sum())
        far += int((told < full - 1e-6).sum())
    assert below > 1000
    assert far > 1000
