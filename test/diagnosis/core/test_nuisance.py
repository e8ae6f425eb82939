"""What nuisance parameters can make counts no more than they are known: held against the covariance written out."""

import numpy as np
import pytest

from doormill_ros.diagnosis.core.fitting.nuisance import Alike, Nuisance

ROWS = 40


@pytest.fixture
def parts():
    rng = np.random.default_rng(8)
    group = rng.integers(0, 7, ROWS)
    return rng.normal(size=(ROWS, 3)), Alike(group, rng.uniform(0.5, 4.0, ROWS)), rng


def test_rows_are_taken_to_the_root_of_their_inverse_covariance(parts):
    columns, alike, _ = parts
    same = alike.group[:, None] == alike.group[None, :]
    covariance = np.eye(ROWS) + columns @ columns.T + same * np.outer(alike.effect, alike.effect)
    nuisance = Nuisance(columns, np.zeros((ROWS, 0)), alike)
    root = nuisance.take(np.eye(ROWS))
    np.testing.assert_allclose(root.T @ root, np.linalg.inv(covariance), atol=1e-12)
    assert nuisance.log_determinant == pytest.approx(np.linalg.slogdet(covariance)[1], rel=1e-9)


def test_what_may_be_anything_leaves_nothing(parts):
    columns, alike, rng = parts
    free = rng.normal(size=(ROWS, 2))
    nuisance = Nuisance(columns, free, alike)
    np.testing.assert_allclose(nuisance.take(free), 0.0, atol=1e-12)
    rows = rng.normal(size=(ROWS, 1))
    np.testing.assert_allclose(nuisance.take(rows + 1e3 * free[:, :1]), nuisance.take(rows), atol=1e-8)


def test_a_number_that_whole_groups_share_takes_most_of_their_mean():
    group = np.repeat(np.arange(4), 10)
    alike = Alike(group, np.full(ROWS, 100.0))
    shared = np.array([5.0, -3.0, 2.0, 1.0])[group][:, None]
    left = Nuisance(np.zeros((ROWS, 0)), np.zeros((ROWS, 0)), alike).take(shared)
    assert np.abs(left).max() < 0.02
