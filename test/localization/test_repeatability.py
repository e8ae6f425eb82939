"""The spread of repeated poses against what was stated of them."""

import numpy as np
import pytest

from doormill_ros.localization.repeatability import repeatability

DEVIATION = np.array([2e-5, 3e-5, 4e-5])


def drawn(count, rng, factor=1.0):
    """Poses (n, 3) about one place whose covariances (n, 3, 3), all different, are stated too small by a factor."""
    sizes = rng.uniform(0.5, 2.0, count)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    root = turn * DEVIATION
    poses = np.array([0.003, -0.002, 0.01]) + sizes[:, None] * (rng.normal(size=(count, 3)) @ root.T)
    return poses, np.array([(factor * size) ** 2 * root @ root.T for size in sizes])


def test_chi_square_of_honest_covariances_is_its_degrees_of_freedom():
    rng = np.random.default_rng(0)
    found = [repeatability(*drawn(6, rng)) for _ in range(400)]
    assert {f.freedom for f in found} == {15}
    mean = np.mean([f.chi_square for f in found])
    assert mean == pytest.approx(15.0, abs=4.0 * np.sqrt(2 * 15.0 / 400))
    assert np.mean([f.allowed for f in found]) > 0.97


def test_covariances_half_as_large_are_not_believed():
    rng = np.random.default_rng(1)
    found = repeatability(*drawn(12, rng, factor=0.5))
    assert not found.allowed
    assert found.probability < 1e-4


def test_mean_spread_and_statement_by_hand():
    poses = np.array([[0.0], [3.0]])
    found = repeatability(poses, np.array([[[1.0]], [[4.0]]]))
    assert found.mean == pytest.approx([0.6])  # weights 1 and 1/4
    assert found.spread == pytest.approx([3.0 / np.sqrt(2.0)])
    assert found.stated == pytest.approx([np.sqrt(2.5)])
    assert found.chi_square == pytest.approx(0.36 + 2.4**2 / 4.0)
    assert found.freedom == 1


def test_one_pose_has_no_spread():
    with pytest.raises(ValueError, match="n >= 2"):
        repeatability(np.zeros((1, 3)), np.eye(3)[None])
