"""Shapes of laws: what every entry has to give, whatever drives it."""

import numpy as np
import pytest

from doormill_ros.robot_model.law.shapes import SHAPES, columns

VALUES = np.random.default_rng(3).uniform(-2.0, 5.0, 40)


@pytest.mark.parametrize("name", SHAPES)
def test_numbers_taken_of_values_and_refined_ones_make_columns(name):
    shape = SHAPES[name]
    numbers = shape.numbers(0.5, VALUES)
    wide = columns(name, VALUES, numbers).shape[1]
    for other in (numbers, *shape.refined(numbers)):
        found = columns(name, VALUES, other)
        assert found.shape == (len(VALUES), wide)
        assert np.all(np.isfinite(found))
        assert shape.told("the load", "N", other, ["one"] * wide)


@pytest.mark.parametrize("name", SHAPES)
def test_only_what_is_constant_does_not_follow_what_drives_it(name):
    shape = SHAPES[name]
    found = columns(name, VALUES, shape.numbers(0.5, VALUES))
    assert bool(np.all(np.ptp(found, axis=0) == 0.0)) == shape.constant
    assert shape.stiff or not shape.constant


def test_a_sector_is_also_moved():
    width, at = numbers = SHAPES["sector"].numbers(0.5, VALUES)
    assert {found[1] for found in SHAPES["sector"].refined(numbers)} > {at}
    assert width in {found[0] for found in SHAPES["sector"].refined(numbers)}
