"""Equations 3.51 and 3.52, and what the thesis' two settings (table 4.9) make of them."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from doormill_ros.milling import speeds
from doormill_ros.milling.errors import CuttingParameterError
from doormill_ros.milling.speeds import SURFACE_FOOT_PER_MINUTE as SFM
from doormill_ros.milling.speeds import SURFACE_METRE_PER_MINUTE as SMM
from doormill_ros.milling.speeds import THESIS_CUTTER
from doormill_ros.units import INCH, MM, RPM

positive = st.floats(1e-4, 1e4)


def test_feed_by_hand():
    # 0.5 mm a tooth, two teeth, 3000 turns a minute = 50 turns a second: 0.5 * 2 * 50 = 50 mm/s.
    assert speeds.feed(0.5 * MM, 2, 3000 * RPM) == pytest.approx(50 * MM, rel=1e-14)


def test_surface_speed_by_hand():
    # A 1 m wheel that turns once a second: pi metres a second.
    assert speeds.surface_speed(60 * RPM, 1.0) == pytest.approx(math.pi, rel=1e-14)


@given(speed=positive, load=st.floats(1e-6, 1e-2), diameter=st.floats(1e-3, 0.5), flutes=st.integers(1, 12))
def test_back_and_forth(speed, load, diameter, flutes):
    spindle = speeds.spindle_speed(speed, diameter)
    assert speeds.surface_speed(spindle, diameter) == pytest.approx(speed, rel=1e-12)
    assert speeds.chip_load(speeds.feed(load, flutes, spindle), flutes, spindle) == pytest.approx(
        load, rel=1e-12
    )


def test_initial_setting_is_300_surface_metres_a_minute():
    """5025 rpm (table 4.9) is 300 m/min on 19 mm: where the thesis' starting point comes from."""
    spindle = speeds.spindle_speed(300 * SMM, THESIS_CUTTER.diameter)
    assert spindle / RPM == pytest.approx(5025, abs=1.5)
    data = speeds.from_machine(5025 * RPM, 80 * MM, THESIS_CUTTER)
    # 984 SFM: outside the 700..900 SFM that section 3.9 prescribes for softwood.
    assert data.surface_speed / SFM == pytest.approx(math.pi * 19 / 304.8 * 5025, rel=1e-12)
    assert data.surface_speed / SFM > 900
    # 80 mm/s * 60 / (2 * 5025) = 0.4776 mm = 0.0188 inch: the printed 0.019 inch to its last digit.
    assert data.chip_load / INCH == pytest.approx(0.019, abs=0.0005)
    assert [w.split(" ")[0] for w in data.warnings] == ["surface", "chip"]


def test_final_setting_is_below_both_ranges():
    data = speeds.from_machine(3200 * RPM, 50 * MM, THESIS_CUTTER)
    assert data.surface_speed / SFM == pytest.approx(math.pi * 19 / 304.8 * 3200, rel=1e-12)
    assert data.surface_speed / SFM < 700
    assert data.chip_load / INCH == pytest.approx(50 * 60 / (2 * 3200) / 25.4, rel=1e-12)
    assert data.chip_load / INCH < 0.019
    assert all("below" in w for w in data.warnings)
    assert len(data.warnings) == 2


def test_table_4_9_cannot_be_metres_per_second():
    """The table's unit m/s would be a feed per tooth of half a metre."""
    assert speeds.from_machine(5025 * RPM, 80.0, THESIS_CUTTER).chip_load > 0.4


def test_surface_speed_window_of_the_thesis_cutter():
    low, high = speeds.allowed_spindle(THESIS_CUTTER)
    assert low / RPM == pytest.approx(700 * 304.8 / (math.pi * 19), rel=1e-12)
    assert high / RPM == pytest.approx(900 * 304.8 / (math.pi * 19), rel=1e-12)
    # Neither printed speed lies in the window the thesis itself names.
    assert not low <= 5025 * RPM <= high
    assert not low <= 3200 * RPM <= high


@pytest.mark.parametrize("sfm", [700, 900])
@pytest.mark.parametrize("inch", [0.019, 0.025])
def test_bounds_of_the_ranges_do_not_warn(sfm, inch):
    assert speeds.from_cutting(sfm * SFM, inch * INCH, THESIS_CUTTER).warnings == ()


def test_the_target_feed_of_the_dry_test_fits_every_range():
    """Section 3.9: 70 mm/s; at the printed chip load of 0.019 inch it is inside all ranges, unlike table 4.9."""
    spindle = 70 * MM / (2 * 0.019 * INCH) * 60 * RPM
    assert spindle / RPM == pytest.approx(70 * 60 / (2 * 0.4826), rel=1e-12)
    data = speeds.from_machine(spindle, 70 * MM, THESIS_CUTTER)
    assert data.warnings == ()
    assert data.surface_speed / SFM == pytest.approx(852, abs=0.5)
    assert spindle / RPM == pytest.approx(4351, abs=0.5)


def test_rating_warns():
    data = speeds.from_machine(18001 * RPM, 0.3, THESIS_CUTTER)
    assert any("18001 rpm" in w and "18000" in w for w in data.warnings)


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf, "5", None])
def test_nonsense_is_refused(bad):
    with pytest.raises(CuttingParameterError):
        speeds.spindle_speed(bad, 0.019)
    with pytest.raises(CuttingParameterError):
        speeds.from_machine(500.0, bad, THESIS_CUTTER)


@pytest.mark.parametrize("flutes", [0, -2, 1.5, True])
def test_flutes_are_counted(flutes):
    with pytest.raises(CuttingParameterError):
        speeds.feed(0.0005, flutes, 300.0)


def test_cutter_with_a_range_upside_down_is_refused():
    with pytest.raises(CuttingParameterError, match="lower bound first"):
        speeds.Cutter("x", 0.019, 2, 100.0, (0.002, 0.001), (1.0, 2.0))
