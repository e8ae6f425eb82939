"""Rows left out: solutions without them are those of the other rows alone, and scatter is that of repeated trials."""

import numpy as np
import pytest

from doormill_ros.diagnosis.core.fitting.held_out import gain_in_errors, left_out, scatter_of
from doormill_ros.diagnosis.core.words.verdict import (
    CONSISTENT,
    EXPLAINED,
    PARTLY_EXPLAINED,
    UNEXPLAINED,
    judge,
)


def test_the_solution_without_a_part_is_that_of_the_other_rows():
    rng = np.random.default_rng(1)
    A, b, part = rng.normal(size=(40, 5)), rng.normal(size=40), np.arange(40) % 4
    parts = [(A[part == k].T @ A[part == k], A[part == k].T @ b[part == k]) for k in range(4)]
    found = list(left_out(A.T @ A, A.T @ b, parts, np.linalg.solve))
    assert len(found) == 4
    for k, x in enumerate(found):
        assert x == pytest.approx(np.linalg.lstsq(A[part != k], b[part != k], rcond=None)[0], rel=1e-9)


def test_scatter_is_that_of_repeated_trials_where_rows_of_a_block_err_alike():
    rng = np.random.default_rng(2)
    blocks, rows = 20, 30
    A = rng.normal(size=(blocks * rows, 2)) + 1.0
    block = np.repeat(np.arange(blocks), rows)
    inverse = np.linalg.inv(A.T @ A)
    found, told = [], []
    for _ in range(400):
        b = A @ [1.0, -2.0] + rng.normal(size=blocks)[block] + 0.3 * rng.normal(size=len(A))
        x = inverse @ A.T @ b
        pulls = np.zeros((blocks, 2))
        np.add.at(pulls, block, A * (b - A @ x)[:, None])
        found.append(x)
        told.append(scatter_of(pulls, inverse))
    real = np.std(found, axis=0)
    assert np.sqrt(np.mean(np.square(told), axis=0)) == pytest.approx(real, rel=0.15)
    independent = 1.0 * np.sqrt(np.diag(inverse))
    assert np.all(real > 1.5 * independent), "else the blocks would prove nothing"


def test_gains_in_errors_are_those_of_a_sum():
    fall = np.array([1.0, 2.0, 3.0, 6.0])
    assert gain_in_errors(fall) == pytest.approx(12.0 / (np.std(fall, ddof=1) * 2.0))
    assert gain_in_errors(fall[:1]) == 0.0


@pytest.mark.parametrize(
    ("found", "silent", "quiet", "share", "verdict"),
    [
        (False, True, False, 0.0, CONSISTENT),
        (False, False, False, 0.0, UNEXPLAINED),
        (True, False, True, 0.1, EXPLAINED),
        (True, False, False, 0.6, PARTLY_EXPLAINED),
        (True, False, False, 0.4, UNEXPLAINED),
    ],
)
def test_one_rule_gives_the_verdict(found, silent, quiet, share, verdict):
    assert judge(found, silent, quiet, share, main_part=0.5) == verdict
