"""Geometry of faces and beams: derivatives against differences, hand-made cases."""

import numpy as np
import pytest

from doormill_ros.frames import apply, apply_twist, transform
from doormill_ros.localization.sensors.errors import Contradiction, NotConverged, Undetermined
from doormill_ros.localization.sensors.faces import heights, normals, ranges
from doormill_ros.localization.sensors.fit import Linearised, fit_pose
from support.sensors.pose_errors import SIZES, true_pose

STEP = 1e-6


def differences(function, T_base_door):
    return np.stack(
        [
            (function(apply_twist(T_base_door, e)) - function(apply_twist(T_base_door, -e))) / (2 * STEP)
            for e in STEP * np.eye(6)
        ],
        axis=1,
    )


@pytest.mark.parametrize("seed", range(4))
def test_derivatives_agree_with_differences(seed):
    rng = np.random.default_rng(seed)
    T_base_door = true_pose(SIZES[1], rng)
    outward = normals(("face", "hinge", "bottom", "face"))
    points = apply(T_base_door, rng.uniform(-0.1, 2.0, (4, 3)))
    _, derivative = heights(T_base_door, outward, points)
    expected = differences(lambda T: heights(T, outward, points)[0], T_base_door)
    np.testing.assert_allclose(derivative, expected, atol=1e-7)

    origins = apply(T_base_door, 0.06 * outward + rng.uniform(0, 1, (4, 3)))
    directions = -outward + rng.normal(0, 0.05, (4, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    _, derivative = ranges(T_base_door, outward, origins, directions)
    expected = differences(lambda T: ranges(T, outward, origins, directions)[0], T_base_door)
    np.testing.assert_allclose(derivative, expected, atol=1e-6)


def test_a_beam_ends_on_its_face():
    T_base_door = transform(translation=np.array([1.6, 0.0, 0.0]))
    length, _ = ranges(T_base_door, normals(("face",)), np.array([[1.5, 0.3, 0.7]]), np.array([[1.0, 0, 0]]))
    assert length[0] == pytest.approx(0.1)
    height, _ = heights(T_base_door, normals(("hinge",)), np.array([[1.7, -0.02, 0.5]]))
    assert height[0] == pytest.approx(0.02)


def _points(outward, points, bump=None):
    def linearise(T_base_door):
        height, derivative = heights(T_base_door, outward, points)
        return Linearised(-height + (0 if bump is None else bump), derivative, np.full(len(height), 1e-10))

    return linearise


def test_readings_on_one_face_leave_the_door_open():
    rng = np.random.default_rng(1)
    outward = normals(("face",) * 8)
    points = rng.uniform(0, 1, (8, 3)) * [0, 1, 1]
    with pytest.raises(Undetermined, match="open"):
        fit_pose(np.eye(4), _points(outward, points), "points")
    with pytest.raises(Undetermined, match="5 points"):
        fit_pose(np.eye(4), _points(outward[:5], points[:5]), "points")


def test_a_reading_that_contradicts_the_others_is_noticed():
    rng = np.random.default_rng(2)
    outward = normals(("face",) * 4 + ("hinge",) * 3 + ("bottom",) * 2)
    points = rng.uniform(0, 1, (9, 3)) * (outward == 0)
    fit_pose(np.eye(4), _points(outward, points), "points")
    bump = np.zeros(9)
    bump[1] = 1e-3
    with pytest.raises(Contradiction, match="chi-square"):
        fit_pose(np.eye(4), _points(outward, points, bump), "points")


def test_readings_without_a_pose_do_not_loop_for_ever():
    def linearise(T_base_door):
        rng = np.random.default_rng()
        return Linearised(rng.normal(0, 1, 6), np.eye(6), np.ones(6))

    with pytest.raises(NotConverged):
        fit_pose(np.eye(4), linearise, "points")
