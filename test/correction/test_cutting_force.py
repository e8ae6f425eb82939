"""Cutting forces against the closed form of a slot, and against what every cut must obey."""

import numpy as np
import pytest

from doormill_ros.correction.cutting_force import (
    COEFFICIENTS,
    DIRECTIONS,
    CuttingCoefficients,
    mean_force,
    plunge_force,
    rim_directions,
)
from doormill_ros.recipes.door import Material

WOOD = CuttingCoefficients(specific=30e6, edge=2e3, radial=0.3, spread=0.5)
SLOT = np.ones(DIRECTIONS, dtype=bool)
UP = np.array([0.0, 1.0])
RIGHT = np.array([1.0, 0.0])  # seen from inside the wood; left of the feed as the spindle sees it


def test_a_full_slot_is_that_of_the_closed_form():
    """By hand: mean of sin^2 over half a turn is 1/4 of a turn's, that of sin 1/pi; a depth of 1 m."""
    chip, flutes = 2e-4, 2
    force = mean_force(SLOT, UP, chip, flutes, WOOD)
    across = flutes * (chip * WOOD.specific / 4.0 + WOOD.edge / np.pi)
    along = -flutes * WOOD.radial * (chip * WOOD.specific / 4.0 + WOOD.edge / np.pi)
    assert force == pytest.approx([across, along], rel=1e-3)


def test_a_clockwise_spindle_is_pushed_to_the_left_of_its_feed():
    assert mean_force(SLOT, UP, 1e-4, 2, WOOD) @ RIGHT > 0.0
    assert mean_force(SLOT, -UP, 1e-4, 2, WOOD) @ RIGHT < 0.0


@pytest.mark.parametrize("angle", [0.4, 2.0, 4.5])
def test_the_force_turns_with_the_feed(angle):
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s], [s, c]])
    plain, turned = mean_force(SLOT, UP, 1e-4, 2, WOOD), mean_force(SLOT, R @ UP, 1e-4, 2, WOOD)
    one_direction = (
        2 * WOOD.edge / DIRECTIONS * np.hypot(1.0, WOOD.radial)
    )  # more or less at the ends of the cut
    assert turned == pytest.approx(R @ plain, abs=one_direction)


def test_no_wood_no_force_and_thinner_chips_less():
    assert not mean_force(~SLOT, UP, 1e-4, 2, WOOD).any()
    behind = rim_directions() @ UP < 0.0
    assert not mean_force(behind, UP, 1e-4, 2, WOOD).any()
    thick, thin = (np.linalg.norm(mean_force(SLOT, UP, chip, 2, WOOD)) for chip in (4.5e-4, 1.5e-4))
    assert 1.0 / 3.0 < thin / thick < 0.5  # a third, but for what the edges rub


def test_a_plunge_pushes_by_the_area_under_the_mill():
    whole = plunge_force(1.0, 0.008, 5e-5, 2, WOOD)
    assert plunge_force(0.25, 0.008, 5e-5, 2, WOOD) == pytest.approx(0.25 * whole)
    assert plunge_force(0.0, 0.008, 5e-5, 2, WOOD) == 0.0


def test_every_material_has_coefficients():
    assert set(COEFFICIENTS) == set(Material)
    assert all(0.0 < c.spread <= 1.0 for c in COEFFICIENTS.values())
