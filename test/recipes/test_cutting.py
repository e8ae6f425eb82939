"""Equations 3.51 and 3.52, and what the thesis' two settings (table 4.9) make of them."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from doormill_ros.recipes.cutting import Cutting
from doormill_ros.recipes.tool import Tool
from doormill_ros.units import MM, RPM, rad_s_to_rpm
from support.thesis_milling import INCH, THESIS_CHIP_LOAD, THESIS_MILL, THESIS_SURFACE_SPEED
from support.thesis_milling import SURFACE_FOOT_PER_MINUTE as SFM

positive = st.floats(1e-4, 1e4)


def mill(diameter: float, flutes: int = 2) -> Tool:
    return Tool("mill", diameter, flutes, 0.1, 18000.0 * RPM)


def surface_speed(spindle: float, tool: Tool) -> float:
    """The surface speed that asks for a spindle speed: the equation is a proportion."""
    return spindle / Cutting(surface_speed=1.0, chip_load=1e-3).spindle(tool)


def test_feed_by_hand():
    # 0.5 mm a tooth, two teeth, 3000 turns a minute = 50 turns a second: 0.5 * 2 * 50 = 50 mm/s.
    tool = mill(19 * MM)
    cutting = Cutting(surface_speed=3000 * RPM * tool.radius, chip_load=0.5 * MM)
    assert cutting.feed_rate(tool) == pytest.approx(50 * MM, rel=1e-14)


def test_surface_speed_by_hand():
    # A 1 m wheel that turns once a second: pi metres a second.
    assert Cutting(surface_speed=math.pi, chip_load=1e-3).spindle(mill(1.0)) == pytest.approx(
        60 * RPM, rel=1e-14
    )


@given(speed=positive, load=st.floats(1e-6, 1e-2), diameter=st.floats(1e-3, 0.5), flutes=st.integers(1, 12))
def test_back_and_forth(speed, load, diameter, flutes):
    tool = mill(diameter, flutes)
    derived = Cutting(surface_speed=speed, chip_load=load)
    direct = Cutting(spindle_speed=derived.spindle(tool), feed=derived.feed_rate(tool))
    assert surface_speed(direct.spindle(tool), tool) == pytest.approx(speed, rel=1e-12)
    assert direct.chip(tool) == pytest.approx(load, rel=1e-12)
    assert derived.chip(tool) == pytest.approx(load, rel=1e-12)


def test_initial_setting_is_300_surface_metres_a_minute():
    """5025 rpm (table 4.9) is 300 m/min on 19 mm: where the thesis' starting point comes from."""
    derived = Cutting(surface_speed=300 / 60, chip_load=1e-3)
    assert rad_s_to_rpm(derived.spindle(THESIS_MILL)) == pytest.approx(5025, abs=1.5)
    initial = Cutting(spindle_speed=5025 * RPM, feed=80 * MM)
    # 984 SFM: outside the 700..900 SFM that section 3.9 prescribes for softwood.
    speed = surface_speed(initial.spindle(THESIS_MILL), THESIS_MILL)
    assert speed / SFM == pytest.approx(math.pi * 19 / 304.8 * 5025, rel=1e-12)
    assert speed / SFM > 900
    # 80 mm/s * 60 / (2 * 5025) = 0.4776 mm = 0.0188 inch: the printed 0.019 inch to its last digit.
    assert initial.chip(THESIS_MILL) / INCH == pytest.approx(0.019, abs=0.0005)
    assert initial.chip(THESIS_MILL) < THESIS_CHIP_LOAD[0]


def test_final_setting_is_below_both_ranges():
    final = Cutting(spindle_speed=3200 * RPM, feed=50 * MM)
    speed = surface_speed(final.spindle(THESIS_MILL), THESIS_MILL)
    assert speed / SFM == pytest.approx(math.pi * 19 / 304.8 * 3200, rel=1e-12)
    assert speed / SFM < 700
    assert final.chip(THESIS_MILL) / INCH == pytest.approx(50 * 60 / (2 * 3200) / 25.4, rel=1e-12)
    assert final.chip(THESIS_MILL) / INCH < 0.019
    assert speed < THESIS_SURFACE_SPEED[0]


def test_table_4_9_cannot_be_metres_per_second():
    """The table's unit m/s would be a feed per tooth of half a metre."""
    assert Cutting(spindle_speed=5025 * RPM, feed=80.0).chip(THESIS_MILL) > 0.4


def test_surface_speed_window_of_the_thesis_cutter():
    low, high = (
        Cutting(surface_speed=speed, chip_load=1e-3).spindle(THESIS_MILL) for speed in THESIS_SURFACE_SPEED
    )
    assert low / RPM == pytest.approx(700 * 304.8 / (math.pi * 19), rel=1e-12)
    assert high / RPM == pytest.approx(900 * 304.8 / (math.pi * 19), rel=1e-12)
    assert high < THESIS_MILL.max_spindle_speed
    # Neither printed speed lies in the window the thesis itself names.
    assert not low <= 5025 * RPM <= high
    assert not low <= 3200 * RPM <= high


def test_the_target_feed_of_the_dry_test_fits_every_range():
    """Section 3.9: 70 mm/s; at the printed chip load of 0.019 inch it is inside all ranges, unlike table 4.9."""
    spindle = 70 * MM / (2 * 0.019 * INCH) * 60 * RPM
    assert spindle / RPM == pytest.approx(70 * 60 / (2 * 0.4826), rel=1e-12)
    dry = Cutting(spindle_speed=spindle, feed=70 * MM)
    low, high = THESIS_CHIP_LOAD
    assert low * (1 - 1e-9) <= dry.chip(THESIS_MILL) <= high
    speed = surface_speed(spindle, THESIS_MILL)
    assert THESIS_SURFACE_SPEED[0] <= speed <= THESIS_SURFACE_SPEED[1]
    assert spindle < THESIS_MILL.max_spindle_speed
    assert speed / SFM == pytest.approx(852, abs=0.5)
    assert spindle / RPM == pytest.approx(4351, abs=0.5)
