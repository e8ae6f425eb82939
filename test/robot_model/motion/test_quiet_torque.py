"""A noisy torque loses its noise, and nothing else; what is no noise stays."""

import numpy as np
import pytest

from doormill_ros.measurements.sets.motion_set import read_motion_set
from doormill_ros.robot_model.motion.quiet_torque import quiet_torque, white_noise
from support.source_tree import ROOT

COUNT, NOISE = 5000, 40.0
TIME = np.arange(COUNT) / 250.0
SMOOTH = 150.0 * np.sin(2.0 * np.pi * 0.4 * TIME) + 60.0 * np.sin(2.0 * np.pi * 3.0 * TIME + 1.0) + 300.0


@pytest.mark.parametrize("seed", range(5))
def test_a_slow_torque_keeps_a_small_part_of_its_noise(seed):
    quiet, left = quiet_torque(SMOOTH + np.random.default_rng(seed).normal(0.0, NOISE, COUNT))
    inside = slice(100, -100)
    assert np.std((quiet - SMOOTH)[inside]) < 1.2 * left
    assert left < 0.3 * NOISE


@pytest.mark.parametrize("seed", range(5))
def test_the_noise_is_read_from_neighbours(seed):
    noisy = SMOOTH + np.random.default_rng(seed).normal(0.0, NOISE, COUNT)
    assert white_noise(noisy) == pytest.approx(NOISE, rel=0.05)


def test_a_jump_stays_where_it_is():
    torque = SMOOTH + np.where(TIME > 10.0, 400.0, 0.0)
    quiet, _ = quiet_torque(torque + np.random.default_rng(3).normal(0.0, NOISE, COUNT))
    away = np.abs(quiet - torque)
    assert np.max(away) < 6.0 * NOISE
    assert np.sqrt(np.mean(away**2)) < 0.5 * NOISE


def test_a_torque_with_little_noise_stays_as_it_is():
    torque = SMOOTH + np.random.default_rng(1).normal(0.0, 1.0, COUNT)
    quiet, left = quiet_torque(torque)
    assert left is None
    np.testing.assert_array_equal(quiet, torque)


@pytest.mark.parametrize("torque", [np.zeros(COUNT), np.full(COUNT, 800.0), SMOOTH[:3]])
def test_a_torque_that_was_never_read_stays_as_it_is(torque):
    quiet, left = quiet_torque(torque)
    assert left is None
    np.testing.assert_array_equal(quiet, torque)


@pytest.mark.parametrize("name", ["A", "B"])
def test_the_ripple_of_a_drive_is_no_noise(name):
    data = read_motion_set(ROOT / "test" / "data" / "kr300" / name)
    assert [motion.torque_noise for motion in data.motions] == [None, None, None]
    assert all(white_noise(motion.torque) > 0.03 * np.std(motion.torque) for motion in data.motions)
