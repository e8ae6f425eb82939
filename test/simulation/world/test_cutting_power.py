"""How much wood a mill takes, counted in cells, against lengths times widths times depths."""

import numpy as np
import pytest

from doormill_ros.simulation.world.cutting_power import CutDoor, CutSlab

RADIUS, DEPTH, LENGTH = 8e-3, 5e-3, 0.2
WAY = np.arange(0.0, LENGTH + 1e-9, 1e-3)


def taken(slab: CutSlab, x, y=0.0, z=DEPTH) -> float:
    return sum(slab.take(np.array([one, y, z]), RADIUS) for one in x)


def test_a_slot_takes_its_volume_from_whichever_end_it_is_milled():
    wanted = DEPTH * (2.0 * RADIUS * LENGTH + np.pi * RADIUS**2)
    for x in (WAY, WAY[::-1], -WAY, WAY - 1.0):
        assert taken(CutSlab(), x) == pytest.approx(wanted, rel=0.01)


def test_a_way_that_was_cut_before_takes_nothing_and_a_deeper_one_the_rest():
    slab = CutSlab()
    first = taken(slab, WAY)
    assert taken(slab, WAY) == 0.0
    assert taken(slab, WAY, z=1.5 * DEPTH) == pytest.approx(0.5 * first)


def test_half_the_width_beside_a_slot_takes_half_of_it():
    slab = CutSlab()
    taken(slab, WAY)
    # And at its ends what the union of two discs, a radius apart, has more than one.
    more = (np.pi / 3.0 + np.sqrt(3.0) / 2.0) * RADIUS**2
    assert taken(slab, WAY, y=RADIUS) == pytest.approx(DEPTH * (RADIUS * LENGTH + more), rel=0.01)


@pytest.fixture
def feature(recorded):
    return recorded.recipe.features[0]


def tip_at(recorded, feature, place) -> np.ndarray:
    T = recorded.T_base_door @ recorded.recipe.T_door_feature(feature)
    return T[:3, :3] @ np.asarray(place) + T[:3, 3]


def test_only_wood_below_the_surface_of_a_feature_of_the_recipe_is_taken(recorded, feature):
    door = CutDoor(recorded.recipe, recorded.T_base_door)
    assert door.take(feature.id, tip_at(recorded, feature, (0.0, 0.0, -2e-3))) == 0.0
    assert door.take("", tip_at(recorded, feature, (0.0, 0.0, DEPTH))) == 0.0
    assert door.take("no such feature", tip_at(recorded, feature, (0.0, 0.0, DEPTH))) == 0.0
    whole = np.pi * feature.tool.radius**2 * DEPTH
    assert door.take(feature.id, tip_at(recorded, feature, (0.0, 0.0, DEPTH))) == pytest.approx(
        whole, rel=0.03
    )


def test_a_door_that_stands_elsewhere_is_met_elsewhere(recorded, feature):
    moved = recorded.T_base_door.copy()
    moved[:3, 3] += 1.0
    door = CutDoor(recorded.recipe, moved)
    tip = tip_at(recorded, feature, (0.0, 0.0, DEPTH)) + 1.0
    assert door.take(feature.id, tip) > 0.0


def test_a_recorded_door_loses_the_wood_of_its_features(recorded):
    """A pocket is about as large as its outline times its depth: thesis doors have one of 120 by 30 by 5 mm or so."""
    door = CutDoor(recorded.recipe, recorded.T_base_door)
    path = recorded.path
    gone = sum(
        door.take(str(feature), pose[:3, 3])
        for feature, pose in zip(path.feature, path.T_base_tool_commanded, strict=True)
    )
    again = sum(
        door.take(str(feature), pose[:3, 3])
        for feature, pose in zip(path.feature, path.T_base_tool_commanded, strict=True)
    )
    assert 1e-6 < gone < 1e-3
    assert again < 1e-9
