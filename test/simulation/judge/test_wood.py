"""The wood that may be taken, against shapely and by hand."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from doormill_ros.frames import apply
from doormill_ros.simulation.judge.wood import Pocket, below_surface
from support import doors

KINDS = ("hinge_oblong", "hinge_leaf", "lock_case", "face_plate", "handle_hole")


@pytest.fixture(scope="module", params=KINDS)
def pocket(request):
    door = doors.door_with(request.param, 2000, 800, 40)
    return door, door.features[0], Pocket.of(door, door.features[0])


@given(seed=st.integers(0, 2**32 - 1))
def test_points_are_as_far_outside_as_shapely_says(pocket, seed):
    door, feature, own = pocket
    points = np.random.default_rng(seed).uniform(-0.15, 0.15, (200, 3))
    wall = feature.outline().polygon(chord_error=1e-7)
    beside = shapely.distance(shapely.points(points[:, :2]), wall)
    below = np.maximum(points[:, 2] - feature.cut_depth(door.size), 0.0) * (not feature.through)
    outside = own.outside(apply(door.T_door_feature(feature), points))
    apart = np.hypot(beside, below)
    assert np.allclose(np.maximum(outside, 0.0), apart, atol=1e-6)
    assert np.all((outside <= 0.0) == (apart == 0.0))


def test_a_tool_along_the_wall_is_inside_to_the_micrometre(pocket):
    door, feature, own = pocket
    T, radius = door.T_door_feature(feature), feature.tool.radius
    ring = feature.outline(inset=radius).points(step=1e-3)
    floor = feature.cut_depth(door.size)
    tips = apply(T, np.column_stack([ring, np.full(len(ring), floor)]))
    axis = np.broadcast_to(T[:3, 2], tips.shape)
    wide = np.full(len(tips), radius)
    assert own.excess(tips, axis, 0.12, wide).max() == pytest.approx(0.0, abs=2e-5)
    assert own.excess(tips, axis, 0.12, wide + 1e-3).min() == pytest.approx(1e-3, abs=2e-5)
    deeper = own.excess(tips + 2e-3 * T[:3, 2], axis, 0.12, wide).max()
    assert deeper == pytest.approx(0.0 if feature.through else 2e-3, abs=2e-5)


def test_the_box_of_a_pocket_holds_it_and_no_more(pocket):
    door, feature, own = pocket
    ring = feature.outline().points(step=1e-4)
    floor = np.full(len(ring), feature.cut_depth(door.size))
    rims = [apply(door.T_door_feature(feature), np.column_stack([ring, z])) for z in (0 * floor, floor)]
    assert np.allclose(np.min(rims, axis=(0, 1)), own.low, atol=1e-4)
    assert np.allclose(np.max(rims, axis=(0, 1)), own.high, atol=1e-4)


@pytest.mark.parametrize(
    ("point", "axis", "way"),
    [
        ([0.03, 0.4, 1.0], [1.0, 0.0, 0.0], 0.03),
        ([0.03, 0.4, 1.0], [-1.0, 0.0, 0.0], 0.01),
        ([0.03, 0.4, 1.0], [0.6, 0.8, 0.0], 0.05),
        ([0.03, 0.006, 1.0], [0.6, 0.8, 0.0], 0.0075),
        ([0.03, 0.4, 1.9], [0.0, 0.0, -1.0], 0.1),
    ],
)
def test_how_deep_below_the_surface_a_tool_is(point, axis, way):
    size = np.array([0.04, 0.8, 2.0])
    assert below_surface(np.array([point]), np.array([axis]), size)[0] == pytest.approx(way)
