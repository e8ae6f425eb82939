"""How far beside its path a tool passes that follows late."""

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.doors.late import LAGS, aside

RADIUS, SPEED = 8e-3, 0.06


def round_and_on(count=4001):
    """Times and points of a straight way, then two turns of a circle, at one speed."""
    way = np.linspace(0.0, 0.03 + 4.0 * np.pi * RADIUS, count)
    straight = way < 0.03
    angle = (way - 0.03) / RADIUS
    x = np.where(straight, way - 0.03, RADIUS * np.sin(angle))
    y = np.where(straight, 0.0, RADIUS * (1.0 - np.cos(angle)))
    return way / SPEED, np.column_stack([x, y, np.zeros(count)])


@pytest.mark.parametrize("number", range(len(LAGS)))
def test_on_a_circle_it_passes_inside_by_what_a_lag_of_first_order_leaves_of_the_radius(number):
    time, points = round_and_on()
    found = aside(time, points)[:, number]
    settled = (time > 0.03 / SPEED + 8.0 * LAGS[number]) & (time < time[-1] - LAGS[number])
    passes = points[settled] + found[settled] - [0.0, RADIUS, 0.0]
    turn = SPEED / RADIUS * LAGS[number]
    assert np.linalg.norm(passes, axis=1) == pytest.approx(RADIUS / np.hypot(1.0, turn), rel=2e-5)


def test_along_a_line_it_passes_nowhere_else():
    time = np.linspace(0.0, 1.0, 301)
    points = np.column_stack([SPEED * time, 0.0 * time, 0.0 * time])
    found = aside(time, points)
    assert np.abs(found[..., 1:]).max() == 0.0
    # Along the way it is not there yet at the begin, and not there any more at the end; in between nothing is left.
    between = (time > 0.8) & (time < 1.0 - LAGS[-1])
    assert np.abs(found[between]).max() < 1e-7


def test_a_stop_lets_it_catch_up_and_a_jump_in_no_time_leaves_nothing_behind():
    time, points = round_and_on()
    stop = len(time) // 2
    held = np.concatenate([time[:stop], time[stop:] + 1.0])
    found = aside(
        np.insert(held, stop, held[stop - 1] + 1.0), np.insert(points, stop, points[stop - 1], axis=0)
    )
    assert np.abs(found[stop]).max() < 1e-9
    jumped = aside(np.array([0.0, 1.0, 1.0, 2.0]), np.array([[0.0, 0, 0], [0, 0, 0], [1, 0, 0], [1, 0, 0]]))
    assert np.abs(jumped[[0, 3]]).max() == 0.0
