"""Control charts: what a recipe leaves is judged by what it left before, and only steps end the doors of the limits."""

import json
from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.doors.gauged_door import GaugedDoor
from doormill_ros.diagnosis.parts.kind import Inspections
from doormill_ros.diagnosis.parts.telling.capability import capability_of, capability_table
from doormill_ros.diagnosis.parts.telling.charts import ShiftCharts, control, sums
from support.gauged_shift import HINGE_DOORS, gauged_shift
from support.shift_worlds import inspected

QUIET = lambda line: None  # noqa: E731
BLOCKS = ("a",) * 6 + ("b",) * 6


def charted(now, recipes, before):
    now = np.asarray(now)
    centre, ranges, sigma = control(now, recipes, before)
    names = tuple(f"door_{k:03d}" for k in range(len(now)))
    up, down = sums((now - centre) / max(sigma, 1e-9), recipes)
    return ShiftCharts(names, recipes, now, now, ranges, centre, sigma, before, up, down, ())


def test_sums_add_up_by_recipe_what_is_beyond_the_slack():
    """By hand, with a slack of half a standard deviation: a shift of two adds 1.5 a door, and never below zero."""
    up, down = sums(np.array([2.0, -2.0, 2.0, -2.0, np.nan, -1.0]), ("a", "b", "a", "b", "a", "a"))
    np.testing.assert_allclose(up, [1.5, 0.0, 3.0, 0.0, np.nan, 1.5])
    np.testing.assert_allclose(down, [0.0, 1.5, 0.0, 3.0, np.nan, 0.5])


def levels(rng, recipes):
    return np.array([{"a": 2e-5, "b": 6e-5}[one] for one in recipes]) + rng.normal(0.0, 1e-6, len(recipes))


@pytest.mark.parametrize("recipes", [BLOCKS, ("a", "b") * 6], ids=["blocks", "in turn"])
def test_another_recipe_moves_no_chart(recipes):
    found = charted(levels(np.random.default_rng(3), recipes), recipes, 12).document()
    assert found["individuals"]["beyond"] == found["moving_range"]["beyond"] == []
    assert max(found["cusum"]["above"] + found["cusum"]["below"]) < found["cusum"]["alarm"]
    low, high = (row["centre"] for row in found["individuals"]["by_recipe"])
    assert (low, high) == (pytest.approx(2e-5, rel=0.1), pytest.approx(6e-5, rel=0.1))


def test_a_step_of_one_recipe_among_others_moves_them():
    recipes = ("a", "b") * 8
    now = levels(np.random.default_rng(4), recipes) + 2e-5 * (np.arange(16) >= 9)
    found = charted(now, recipes, 9).document()
    assert found["individuals"]["beyond"] == [f"door_{k:03d}" for k in range(9, 16)]
    assert found["moving_range"]["beyond"] == ["door_009", "door_010"]
    assert found["cusum"]["above"][8] < found["cusum"]["alarm"] < found["cusum"]["above"][9]


@pytest.mark.parametrize(
    ("recipes", "before"), [(BLOCKS, 2), (tuple("abcd") * 3, 4)], ids=["short", "none twice"]
)
def test_without_doors_to_make_them_of_there_are_no_limits(recipes, before):
    charts = charted(np.full(12, 1e-5), recipes, before)
    found = charts.document()
    assert found["individuals"]["limits_origin"].startswith("none: fewer than 3 doors")
    assert {(row["centre"], *row["limits"]) for row in found["individuals"]["by_recipe"]} == {
        (None, None, None)
    }
    assert found["individuals"]["beyond"] == found["moving_range"]["beyond"] == []
    assert set(found["cusum"]["above"]) == {None}
    assert len(charts.blocks()) == 4


def test_a_drift_leaves_the_limits_to_the_doors_before_the_step(tmp_path):
    wear = {"wear_per_door": 0.03}
    moved = {"camera": {"moved": [0.0, 2.5e-4, 0.0], "from_door": 6}}
    sets = inspected(gauged_shift(tmp_path, {"seed": 5, "force": wear, **moved}, HINGE_DOORS[:1] * 9, 5))
    sections = Inspections().account(Inspections().diagnose(sets, QUIET), sets, [], QUIET).sections
    assert {change["kind"] for change in sections["changes"]} == {"drift", "step"}
    origin = sections["charts"]["individuals"]["limits_origin"]
    assert origin == "mean moving range of door_000 to door_005, by recipe"


def test_capability_tells_what_varies_within_doors_from_what_varies_between_them(tmp_path):
    door: GaugedDoor = inspected(gauged_shift(tmp_path, {"seed": 1}, HINGE_DOORS[:1], 1))[0].door
    rng = np.random.default_rng(5)
    noise = rng.normal(0.0, 2e-5, (6, len(door.points)))
    doors = [
        replace(door, points=replace(door.points, deviation=part + level))
        for part, level in zip(noise, 1e-4 * np.array([-1, 1] * 3), strict=True)
    ]
    [found] = capability_of(doors)
    assert (found["doors"], found["points"]) == (6, noise.size)
    assert found["cpk"] == pytest.approx(5e-4 / (3 * 2e-5), rel=0.05)
    assert found["ppk"] == pytest.approx(5e-4 / (3 * np.hypot(1e-4, 2e-5)), rel=0.05)


@pytest.mark.parametrize("each", [1, 2])
def test_a_standard_deviation_has_the_degrees_of_freedom_that_its_doors_leave(tmp_path, each):
    door: GaugedDoor = inspected(gauged_shift(tmp_path, {"seed": 1}, HINGE_DOORS[:1], 1))[0].door
    rng = np.random.default_rng(6)
    doors = [
        replace(door, points=replace(door.points, deviation=off)[:each])
        for off in rng.normal(0.0, 1e-5, (400, len(door.points)))
    ]
    [found] = capability_of(doors)
    assert found["ppk"] == pytest.approx(5e-4 / (3 * 1e-5), rel=0.1)
    if each == 1:
        assert (found["std_within"], found["cpk"]) == (None, None)
        json.dumps(found, allow_nan=False)
        assert capability_table([found])
    else:
        assert found["std_within"] == pytest.approx(1e-5, rel=0.1)
