"""Wrenches moved and turned do the same work, and table 4.8 is about forces at the tool tip."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.correction.wrench import lever_arm, moved, turned

# Table 4.8 of the thesis: left line, top turn, right line, bottom turn; N and N m.
TABLE_4_8 = np.array(
    [
        [-209, 29, 12, -5, -43, 3],
        [-100, 13, 25, -3, -26, 2],
        [-62, 3, -11, -1, -8, 2],
        [-13, 2, -22, -1, 4, 0],
    ],
    dtype=float,
)


def test_moving_keeps_the_power_on_every_twist():
    """A rigid body's velocity at the new point, times the moved wrench, is the same power."""
    rng = np.random.default_rng(3)
    wrench, twist, arm = rng.normal(size=(50, 6)), rng.normal(size=(50, 6)), np.array([0.1, -0.3, 0.7])
    there = np.concatenate([twist[:, :3] + np.cross(twist[:, 3:], arm), twist[:, 3:]], axis=1)
    power = np.einsum("ni,ni->n", wrench, twist)
    assert np.einsum("ni,ni->n", moved(wrench, arm), there) == pytest.approx(power, abs=1e-12)


def test_turning_keeps_the_power():
    rng = np.random.default_rng(4)
    wrench, twist = rng.normal(size=(20, 6)), rng.normal(size=(20, 6))
    R = Rotation.random(20, rng=rng).as_matrix()
    power = np.einsum("ni,ni->n", wrench, twist)
    assert np.einsum("ni,ni->n", turned(R, wrench), turned(R, twist)) == pytest.approx(power, abs=1e-12)


def test_the_arm_behind_pure_forces_is_found():
    rng = np.random.default_rng(5)
    force = rng.normal(size=(10, 3)) * 100
    wrench = np.concatenate([force, np.cross([0, 0, 0.25], force)], axis=1)
    assert lever_arm(wrench) == pytest.approx(0.25, abs=1e-12)
    assert moved(wrench, np.array([0, 0, 0.25]))[:, 3:] == pytest.approx(np.zeros((10, 3)), abs=1e-12)


def test_table_4_8_is_read_a_hand_behind_the_tool_tip():
    """The strongest segment alone, -43 = a (-209), gives 0.206 m; all four together nearly the same."""
    arm = lever_arm(TABLE_4_8)
    assert arm == pytest.approx(43 / 209, abs=0.005)
    left = moved(TABLE_4_8, np.array([0.0, 0.0, arm]))[0]
    # What is left of 43 N m is what rounding to 1 N m can leave, and 1 % of the arm.
    assert np.abs(left[3:5]).max() < 1.1


def test_recipes_take_the_same_arm(cell_recipe):
    for feature in cell_recipe.features:
        given_at = np.array([0.0, 0.0, feature.wrench_point])
        for name, row in zip(("left_line", "top_turn", "right_line", "bottom_turn"), TABLE_4_8, strict=True):
            assert feature.wrench(name) == pytest.approx(moved(row, given_at), abs=1e-9)
        assert feature.wrench_point == pytest.approx(lever_arm(TABLE_4_8), abs=5e-4)


@pytest.fixture
def cell_recipe():
    from doormill_ros.recipes.documents import load_recipe

    return load_recipe("thesis_190_0deg")
