"""Placing a set by few rows."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.diagnosis.pose.fitting.placement import Seen, place_together
from doormill_ros.frames import displacement
from doormill_ros.measurements.errors import PosePlacementError
from doormill_ros.robot_model.pose.chain import Placement, frames, link_transforms


@pytest.fixture
def scene(invented):
    rng = np.random.default_rng(11)
    q = rng.uniform(-2.5, 2.5, (200, 6))
    T = frames(link_transforms(invented["dh"], q))
    true = Placement(displacement(rng.normal(scale=2.0, size=6)), displacement(0.3 * rng.normal(size=6)))
    seen = true.T_tracker_base @ T[:, -1] @ true.T_flange_target
    position = seen[:, :3, 3] + rng.normal(0.0, 1.5e-5, (200, 3))
    rotation = Rotation.from_rotvec(rng.normal(0.0, 6e-5, (200, 3))).as_matrix() @ seen[:, :3, :3]
    return T, position, rotation, seen


@pytest.mark.parametrize("count", [4, 8, 30])
def test_few_rows_place_all(scene, count):
    T, position, rotation, seen = scene
    found = place_together([Seen(T[:count], position[:count], rotation[:count])], (1.5e-5, 6e-5))
    predicted = found.T_tracker_base @ T[:, -1] @ found.T_flange_target
    error = np.linalg.norm(predicted[:, :3, 3] - seen[:, :3, 3], axis=1)
    assert np.sqrt(np.mean(error**2)) < 4.0e-4 / count


def test_gross_errors_among_the_rows_do_not_steer(scene):
    T, position, rotation, seen = scene
    rows = np.arange(12)
    spoilt = position.copy()
    spoilt[4] += [0.02, 0.0, 0.01]
    found = place_together([Seen(T[rows], spoilt[rows], rotation[rows])], (1.5e-5, 6e-5))
    predicted = found.T_tracker_base @ T[:, -1] @ found.T_flange_target
    assert np.linalg.norm(predicted[:, :3, 3] - seen[:, :3, 3], axis=1).max() < 2e-4


def test_two_rows_are_too_few(scene):
    T, position, rotation, _ = scene
    with pytest.raises(PosePlacementError, match="at least 3"):
        place_together([Seen(T[:2], position[:2], rotation[:2])], (1.5e-5, 6e-5))
