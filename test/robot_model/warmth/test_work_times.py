"""How warm a cell is by the doors that it milled: never warmer than an arm that cools no faster than it warms."""

import numpy as np
import pytest

from doormill_ros.robot_model.warmth.work_times import KEPT, WorkTimes

TAKT, HOUR = 180.0, 3600.0
HOURS = 0.7


def doors(begin, count, takt=TAKT):
    return [begin + takt * number for number in range(count)]


def law(seconds):
    return pytest.approx(-np.expm1(-seconds / HOUR / HOURS), abs=1e-6)


def arm(moments, at, slower):
    """Warmth of an arm, second by second: heated for a takt from each door on, else `slower` times as slow to cool."""
    warmth, rate = 0.0, 1.0 / (HOUR * HOURS)
    for time in np.arange(moments[0], at):
        working = any(moment <= time < moment + TAKT for moment in moments)
        warmth += (1.0 - warmth) * rate if working else -warmth * rate / slower
    return warmth


def test_work_without_a_pause_warms_up_as_the_law_says():
    work = WorkTimes(doors(1e9, 21))
    for hours in (0.25, HOURS, 4.0):
        for waited in (0.0, TAKT / 2.0, TAKT):
            passed = 20 * TAKT + waited
            found = work.warmth(1e9 + passed, hours, TAKT)
            assert found == pytest.approx(1.0 - np.exp(-passed / HOUR / hours))
    assert work.warmth(1e9 + 21 * TAKT, HOURS, 5.0 * TAKT) == law(21 * TAKT)


@pytest.mark.parametrize("pause", [2.0 * TAKT, 0.25 * HOUR, HOUR, 3.0 * HOUR])
@pytest.mark.parametrize("slower", [1.0, 3.0])
def test_after_a_pause_it_is_no_warmer_than_an_arm_that_cools_as_slowly_as_it_likes(pause, slower):
    morning = doors(0.0, 25)
    again = morning[-1] + pause
    moments = [*morning, *doors(again, 8)]
    for at in (morning[-1] + pause / 2.0, again, again + TAKT, moments[-1]):
        known = [moment for moment in moments if moment <= at]
        found, real = WorkTimes(known).warmth(at, HOURS, TAKT), arm(known, at, slower)
        assert found <= real + 1e-3
        if slower == 1.0:
            assert found == pytest.approx(real, abs=1e-3)


def test_a_door_now_and_then_keeps_no_arm_as_warm_as_work_does():
    seldom = doors(0.0, 200, 5.0 * TAKT)
    found = WorkTimes(seldom).warmth(seldom[-1], HOURS, TAKT)
    assert 0.1 < found < 0.3  # about the share of the time in which it works


def test_after_a_night_it_is_cold_and_warms_up_anew():
    work = WorkTimes(doors(0.0, 100))
    evening = 99 * TAKT
    assert work.warmth(evening, HOURS, TAKT) > 0.99
    morning = evening + 14.0 * HOUR
    assert work.warmth(morning, HOURS, TAKT) < 1e-6
    work.worked(morning)
    assert work.warmth(morning + TAKT, HOURS, TAKT) == law(TAKT)


def test_what_nobody_saw_counts_as_cold():
    assert WorkTimes().warmth(1e9, HOURS, TAKT) == 0.0
    work = WorkTimes(doors(1e9, 40))
    assert work.warmth(1e9 - HOUR, HOURS, TAKT) == 0.0
    work.worked(1e9 - HOUR)  # the clock was set back
    assert work.doors == 1
    assert work.warmth(1e9 - HOUR + TAKT, HOURS, TAKT) == law(TAKT)


def test_doors_are_forgotten_when_there_are_too_many():
    work = WorkTimes(doors(0.0, KEPT + 10, 1.0))
    assert work.doors == KEPT
    assert work.warmth(float(KEPT + 10), HOURS, TAKT) == law(float(KEPT))
