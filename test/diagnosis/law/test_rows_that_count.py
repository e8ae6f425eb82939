"""How many rows count as one where what is left repeats itself within what was left out together."""

import numpy as np
import pytest

from doormill_ros.diagnosis.law.linear import LinearProblem
from doormill_ros.diagnosis.law.remainder import excess


@pytest.mark.parametrize("length", [1, 4, 6, 10])
def test_rows_that_are_the_same_within_blocks_count_once(length):
    rng = np.random.default_rng(length)
    blocks = 600
    left = np.repeat(rng.normal(size=blocks), length)[:, None]
    problem = LinearProblem(left, np.ones(1), None, np.repeat(np.arange(blocks), length), 1.0)
    # Pairs within a block are equal at every lag below its length, and no pair of two blocks is asked.
    expected = np.sqrt(np.mean(left**2) * (1.0 + 2.0 * (length - 1)))
    assert excess(left, problem) == pytest.approx(expected, rel=0.05)
