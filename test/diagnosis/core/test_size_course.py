"""What is told of doors of note is what the course makes of them."""

import numpy as np
import pytest

from doormill_ros.diagnosis.core.course import (
    ALWAYS,
    BEGINS,
    CHANGES,
    DRIFTS,
    WEARS_AND_CHANGES,
    SizeCourse,
)

FIRST, STEP, LAST = 100.0, 160.0, 300.0


@pytest.mark.parametrize("kind", [ALWAYS, BEGINS, CHANGES, DRIFTS, WEARS_AND_CHANGES])
def test_sizes_are_told_as_they_are_at_the_first_door_before_the_step_and_at_the_last(kind):
    course = SizeCourse(kind, STEP, FIRST, LAST)
    theta = np.random.default_rng(11).normal(size=(course.sizes, 2))
    at = {"at_first": FIRST, "before": np.nextafter(STEP, FIRST), "": LAST}
    told = course.told(theta)
    assert next(iter(told)) == ""
    for suffix, found in told.items():
        assert found == pytest.approx(course.size(theta, np.array([at[suffix]]))[0], abs=1e-9)
    assert ("before" in told) is (course.steps and kind != BEGINS)
    assert ("at_first" in told) is course.drifts


def test_what_wears_and_changes_is_the_product_of_both():
    course, times = SizeCourse(WEARS_AND_CHANGES, STEP, FIRST, LAST), np.linspace(FIRST, LAST, 9)
    found = course.size(np.array([[0.1], [0.4], [-0.3]]), times)[:, 0]
    late = np.linspace(0.0, 1.0, 9)
    assert 1.0 + found == pytest.approx(1.1 * (1.0 + 0.4 * late) * np.where(times >= STEP, 0.7, 1.0))


def test_small_sizes_go_as_their_weights_say():
    rng = np.random.default_rng(12)
    times = rng.uniform(FIRST, LAST, 20)
    for kind in (ALWAYS, BEGINS, CHANGES, DRIFTS, WEARS_AND_CHANGES):
        course = SizeCourse(kind, STEP, FIRST, LAST)
        theta = 1e-6 * rng.normal(size=(course.sizes, 2))
        assert course.size(theta, times) == pytest.approx(course.weights(times) @ theta, abs=1e-10)
