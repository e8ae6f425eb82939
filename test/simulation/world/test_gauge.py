"""The gauge against the judge of every run, which measures in another way, and against doors moved by hand."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.frames import inverse, transform
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.simulation.world.gauge import NOISE, gauge


def measured(recorded, T_base_door=None, noise=0.0, seed=0):
    T_base_door = recorded.T_base_door if T_base_door is None else T_base_door
    return gauge(recorded.recipe, T_base_door, recorded.path, np.random.default_rng(seed), noise)


def test_walls_are_where_the_judge_finds_them(recorded):
    points = measured(recorded)
    part = inspect(recorded.recipe, recorded.T_base_door, recorded.path)
    wall = np.array(points.surface) == "wall"
    differences = []
    for feature in recorded.recipe.features:
        result, rows = part.feature(feature.id), wall & (np.array(points.feature) == feature.id)
        T = inverse(recorded.recipe.T_door_feature(feature))
        place = points.point[rows] @ T[:3, :3].T + T[:3, 3]
        assert place[:, 2] == pytest.approx(np.full(rows.sum(), result.depths[2])), "half way down"
        nearest = np.linalg.norm(place[:, None, :2] - result.points[None], axis=2).argmin(axis=1)
        differences.append(points.deviation[rows] - result.by_depth[2][nearest])
    off = np.concatenate(differences)
    assert len(off) > 150
    # One point a hinge lies where the load jumps and the wall has a step: along the normal is not the nearest there.
    # Where the load changes over 12 mm of the way the wall slopes by 3 %: 4 um to the judge's next point.
    assert np.sum(np.abs(off) > 4e-6) <= len(recorded.recipe.features)


def test_floors_are_as_deep_as_the_judge_finds_them(recorded):
    points = measured(recorded)
    part = inspect(recorded.recipe, recorded.T_base_door, recorded.path)
    floor = np.array(points.surface) == "floor"
    assert floor.sum() > 40
    for feature in recorded.recipe.features:
        low, high = part.feature(feature.id).floor
        found = points.deviation[floor & (np.array(points.feature) == feature.id)]
        assert low - 2e-5 < found.min()
        assert found.max() < high + 2e-5


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_door_that_stands_0_2_mm_further_along_an_axis_has_its_walls_0_2_mm_off(recorded, axis):
    """The pocket is 0.2 mm back in the door: wood is left where the normal points along the way, gone opposite."""
    way = 2e-4 * np.eye(3)[axis]
    still, off = measured(recorded), measured(recorded, transform(translation=way) @ recorded.T_base_door)
    assert off.feature == still.feature
    turned = recorded.T_base_door[:3, :3].T @ way
    expected = -still.normal @ turned
    # Elsewhere two stretches of the tool's way meet and the other one makes the wall.
    off_by = np.abs(off.deviation - still.deviation - expected)
    assert np.quantile(off_by, 0.9) < 3e-6
    assert np.abs(expected).max() == pytest.approx(2e-4, rel=0.05)


def test_normals_point_from_the_pocket_into_the_wood(recorded):
    points = measured(recorded)
    np.testing.assert_allclose(np.linalg.norm(points.normal, axis=1), 1.0)
    for feature in recorded.recipe.features:
        T = recorded.recipe.T_door_feature(feature)
        rows = np.array(points.feature) == feature.id
        out = np.sum((points.point[rows] - T[:3, 3]) * points.normal[rows], axis=1)
        assert np.all(out > 0.0)


def test_the_gauges_noise_is_what_the_inspection_says_and_repeats_with_its_seed(recorded):
    exact, noisy = measured(recorded), measured(recorded, noise=NOISE, seed=4)
    drawn = noisy.deviation - exact.deviation
    assert drawn.std() == pytest.approx(NOISE, rel=4.0 / np.sqrt(2.0 * len(drawn)))
    np.testing.assert_array_equal(noisy.deviation, measured(recorded, noise=NOISE, seed=4).deviation)
    assert not np.array_equal(noisy.deviation, measured(recorded, noise=NOISE, seed=5).deviation)


def test_where_nothing_was_milled_nothing_is_measured(recorded):
    half = recorded.path.feature == "hinge_1"
    path = replace(recorded.path, cutting=recorded.path.cutting & half)
    points = gauge(recorded.recipe, recorded.T_base_door, path, np.random.default_rng(0))
    assert set(points.feature) == {"hinge_1"}
