"""Corners that a lagging controller cuts."""

import numpy as np
import pytest

from doormill_ros.simulation.world.corners import cut_corners

LEG = 0.02  # m


def right_angle(step=2e-4, dwell=0.0):
    """There along x, on along y; stands in the corner for a time."""
    s = np.arange(0.0, LEG + step / 2, step)
    there = np.column_stack([s, 0 * s, 0 * s])
    on = np.column_stack([LEG + 0 * s, s, 0 * s])
    points = np.concatenate([there, on])  # the corner twice
    time = np.concatenate([s, LEG + dwell + s]) / 0.05
    return time, points, len(s) - 1


@pytest.mark.parametrize("cut", [1e-4, 3e-4, 1e-3])
def test_a_right_angle_is_passed_as_far_off_as_the_file_says(cut):
    time, points, corner = right_angle()
    rounded = cut_corners(time, points, cut)
    off = rounded[corner] - points[corner]
    assert np.linalg.norm(off) == pytest.approx(cut, rel=1e-9)
    np.testing.assert_allclose(off, cut / np.sqrt(2.0) * np.array([-1.0, 1.0, 0.0]), rtol=1e-9)


def test_away_from_the_corner_and_at_both_ends_the_path_stays():
    cut = 3e-4
    time, points, _ = right_angle()
    rounded = cut_corners(time, points, cut)
    far = np.linalg.norm(points - points[len(points) // 2], axis=1) > 4.0 * np.sqrt(2.0) * cut
    assert far.sum() > 100
    np.testing.assert_allclose(rounded[far], points[far], atol=1e-12)
    np.testing.assert_array_equal(rounded[[0, -1]], points[[0, -1]])


def test_a_corner_in_which_the_robot_comes_to_rest_is_sharp():
    time, points, _ = right_angle(dwell=0.01)
    np.testing.assert_allclose(cut_corners(time, points, 3e-4), points, atol=1e-12)


def test_the_cut_does_not_depend_on_how_finely_the_path_is_sampled():
    fine, coarse = (right_angle(step) for step in (1e-4, 5e-4))
    cuts = [np.linalg.norm((cut_corners(t, p, 3e-4) - p)[k]) for t, p, k in (fine, coarse)]
    assert cuts[0] == pytest.approx(cuts[1], rel=1e-9)


def test_no_cut_is_no_change():
    time, points, _ = right_angle()
    assert cut_corners(time, points, 0.0) is points
