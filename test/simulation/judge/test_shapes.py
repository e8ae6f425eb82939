"""Gaps between bodies and a box: by hand where that can be done, by other methods where not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from doormill_ros.simulation.judge.shapes import box_gap, cylinder_gap, nearest_on_segment, segment_gap

HALF = np.array([0.2, 0.3, 0.1])
SEEDS = st.integers(0, 2**32 - 1)


def capsule(start, end, radius=0.05):
    return segment_gap(np.array([start]), np.array([end]), radius, HALF)[0]


def cylinder(start, end, radius=0.05):
    return cylinder_gap(np.array([start]), np.array([end]), np.array([radius]), HALF)[0]


@pytest.mark.parametrize(
    ("start", "end", "gap"),
    [
        ([-1.0, 0.0, 0.25], [1.0, 0.0, 0.25], 0.10),  # along a face
        ([0.3, 0.4, -1.0], [0.3, 0.4, 1.0], np.hypot(0.1, 0.1) - 0.05),  # along an edge
        ([0.3, 0.4, 0.2], [0.9, 1.4, 1.2], np.sqrt(3) * 0.1 - 0.05),  # a corner, the near end counts
        ([0.6, 0.0, 0.0], [0.2, 0.0, 0.4], np.sqrt(2) * 0.15 - 0.05),  # across an edge
        ([0.0, 0.0, 0.4], [0.0, 0.0, 0.12], -0.03),  # its round end is 30 mm deep in the face
        ([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], -0.25),  # right through: sideways out is the shortest way
        ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], -0.15),  # a ball in the middle
    ],
)
def test_capsules_by_hand(start, end, gap):
    assert capsule(start, end) == pytest.approx(gap, abs=1e-12)
    assert capsule(end, start) == pytest.approx(gap, abs=1e-12)


@pytest.mark.parametrize(
    ("start", "end", "gap"),
    [
        ([0.0, 0.0, 0.4], [0.0, 0.0, 0.12], 0.02),  # flat end before a face
        ([0.0, 0.0, 0.4], [0.0, 0.0, 0.08], -0.02),  # and in it
        ([-1.0, 0.0, 0.25], [1.0, 0.0, 0.25], 0.10),  # lying on a face
        ([0.3, 0.4, -1.0], [0.3, 0.4, 1.0], np.hypot(0.1, 0.1) - 0.05),  # along an edge
    ],
)
def test_cylinders_by_hand(start, end, gap):
    assert cylinder(start, end) == pytest.approx(gap, abs=1e-12)
    assert cylinder(end, start) == pytest.approx(gap, abs=1e-12)


def test_boxes_by_hand():
    turned = Rotation.from_euler("z", 45, degrees=True).as_matrix()
    side = np.array([0.1, 0.1, 0.1])
    assert box_gap(np.array([[0.4, 0, 0]]), np.eye(3)[None], side, HALF)[0] == pytest.approx(0.1)
    assert box_gap(np.array([[0.4, 0, 0]]), turned[None], side, HALF)[0] == pytest.approx(0.2 - np.sqrt(0.02))
    assert box_gap(np.array([[0.25, 0, 0]]), np.eye(3)[None], side, HALF)[0] == pytest.approx(-0.05)


@given(SEEDS)
def test_the_nearest_point_of_a_segment_is_nearer_than_any_other(seed):
    rng = np.random.default_rng(seed)
    start, end = rng.uniform(-0.8, 0.8, (2, 40, 3))
    near = nearest_on_segment(start, end, HALF)
    share = np.linspace(0.0, 1.0, 501)[:, None, None]
    others = start + share * (end - start)

    def distance(points):
        return np.linalg.norm(np.maximum(np.abs(points) - HALF, 0.0), axis=-1)

    assert np.all(distance(near) <= distance(others).min(axis=0) + 1e-12)
    # It lies on the segment.
    way = np.linalg.norm(near - start, axis=1) + np.linalg.norm(near - end, axis=1)
    assert np.allclose(way, np.linalg.norm(end - start, axis=1), atol=1e-9)


@given(SEEDS)
def test_boxes_meet_where_linear_programming_finds_a_common_point(seed):
    rng = np.random.default_rng(seed)
    centre, extent = rng.uniform(-0.6, 0.6, 3), rng.uniform(0.02, 0.4, 3)
    turn = Rotation.random(rng=rng).as_matrix()
    gap = box_gap(centre[None], turn[None], extent, HALF)[0]
    # Points x with |x| <= HALF and |turn^T (x - centre)| <= extent, and how much room they leave.
    rows = np.concatenate([np.eye(3), -np.eye(3), turn.T, -turn.T])
    limits = np.concatenate([HALF, HALF, extent + turn.T @ centre, extent - turn.T @ centre])
    room = linprog(
        [0, 0, 0, -1.0],
        A_ub=np.column_stack([rows, np.ones(len(rows))]),
        b_ub=limits,
        bounds=[(None, None)] * 4,
    )
    assert room.success
    assert (gap <= 0.0) == (-room.fun >= 0.0)


@given(SEEDS)
def test_a_gap_of_a_cylinder_is_kept_by_all_its_points(seed):
    rng = np.random.default_rng(seed)
    start, end = rng.uniform(-0.6, 0.6, (2, 3))
    radius = rng.uniform(0.01, 0.2)
    gap = cylinder_gap(start[None], end[None], np.array([radius]), HALF)[0]
    share, angle = rng.uniform(0, 1, 4000), rng.uniform(0, 2 * np.pi, 4000)
    frame = Rotation.align_vectors([(end - start)], [[0, 0, 1.0]])[0].as_matrix()
    wide = radius * np.sqrt(rng.uniform(0, 1, 4000))
    round_ = frame @ np.stack([wide * np.cos(angle), wide * np.sin(angle), np.zeros(4000)])
    points = start + share[:, None] * (end - start) + round_.T
    distance = np.linalg.norm(np.maximum(np.abs(points) - HALF, 0.0), axis=1).min()
    assert gap <= distance + 1e-12
    # Where points of it lie well inside the box, it is said to meet.
    deep = np.min(HALF - np.abs(points), axis=1).max()
    assert deep <= 0.0 or gap < 0.0
