"""Figures and warnings of `recipes check`: what a carpenter would say."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.recipes.cutting import Cutting
from doormill_ros.recipes.cutting_advice import cutting_table, warnings
from doormill_ros.recipes.documents import load_recipe, shipped_recipes
from doormill_ros.units import MM, RPM

HINGE = load_recipe("nine_point_door").features[0]  # 19 mm, two flutes, 0.483 to 0.635 mm, 213 to 274 m/min


def turning(rpm, feed, **tool):
    return replace(HINGE, cutting=Cutting(rpm * RPM, feed * MM), tool=replace(HINGE.tool, **tool))


def words(feature):
    return [
        word
        for said in warnings(feature)
        for word in ("rpm", "thick", "m/min")
        if f" {word}" in said.split(",")[0]
    ]


def test_the_ranges_of_the_thesis_exclude_speeds_for_wood():
    """In its surface speeds a mill of 19 mm turns at 3,568 to 4,590 rpm; at 12,000 the edge moves at 716 m/min."""
    assert words(turning(4500, 0.5 * 2 * 75)) == ["rpm"]
    (said,) = warnings(turning(4500, 0.5 * 2 * 75))
    assert "found" not in said
    assert "4500 rpm, wood is milled at 12000 to 18000 rpm" in said
    assert words(turning(12000, 0.5 * 2 * 200)) == ["m/min"]
    assert "716 m/min, mill_19 is for 213 to 274 m/min" in warnings(turning(12000, 200))[0]
    assert words(turning(12000, 50)) == ["thick", "m/min"]
    assert "0.125 mm thick, mill_19 is for 0.483 mm and more" in warnings(turning(12000, 50))[0]


def test_the_final_values_of_table_4_9_are_warned_of():
    """50 mm/s at 3,200 rpm: 0.469 mm and 191 m/min."""
    said = warnings(load_recipe("thesis_190_0deg").features[0])
    assert len(said) == 3
    assert "3200 rpm" in said[0]
    assert "0.469 mm" in said[1]
    assert "191 m/min" in said[2]


def test_a_tool_that_may_not_turn_so_fast_is_not_blamed_for_it():
    assert "rpm" not in words(turning(4500, 75, max_spindle_speed=8000.0 * RPM))
    assert "12000 to 15000 rpm" in warnings(turning(4500, 75, max_spindle_speed=15000.0 * RPM))[0]


def test_what_nobody_told_of_a_tool_is_not_warned_of():
    silent = dict.fromkeys(("min_chip_load", "min_surface_speed", "max_surface_speed"))
    assert warnings(turning(12000, 50, **silent)) == []
    assert warnings(turning(18000, 50, **silent)) == []
    assert words(turning(17999, 50, max_spindle_speed=30000 * RPM, **silent)) == []
    assert words(turning(18001, 50, max_spindle_speed=30000 * RPM, **silent)) == ["rpm"]


@pytest.mark.parametrize("name", ["standard_door", "leaf_hinge_door"])
def test_the_doors_of_today_are_warned_of_nothing(name):
    assert [said for feature in shipped_recipes()[name].features for said in warnings(feature)] == []


def test_the_table_has_a_row_for_each_feature():
    features = load_recipe("standard_door").features
    lines = cutting_table(features).splitlines()
    assert len(lines) == 1 + len(features)
    hole = lines[5].split()
    assert hole[0] == "handle_hole"
    assert float(hole[1]) == pytest.approx(754.0 / (np.pi * 0.016), abs=1.0)
    assert (hole[2], hole[3], hole[4]) == ("0.150", "754", "climb")
    assert lines[5].endswith("ramp, 25 deg at most")
    straight = [replace(f, tool=replace(f.tool, centre_cutting=True)) for f in features]
    assert cutting_table(straight).splitlines()[5].endswith("straight")
