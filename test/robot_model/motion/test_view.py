"""What causes see of a joint in motion."""

import numpy as np
import pytest

from doormill_ros.robot_model.motion.view import JointMotion


@pytest.mark.parametrize("rate", [100.0, 250.0, 1000.0])
@pytest.mark.parametrize("delay", [0.0, 2.9e-3])
def test_acceleration_is_that_of_the_motor_in_every_sample(rate, delay):
    time = np.round(np.arange(int(8 * rate)) / rate, 4)
    motor = 0.5 * np.sin(2.0 * time)
    motion = JointMotion(1, time, motor, motor, np.zeros(len(time)), 250.0, 1.0e6)
    wanted = -2.0 * np.sin(2.0 * (time - delay))
    assert motion.seen(delay).acceleration == pytest.approx(wanted, abs=0.1)
    inner = slice(int(0.05 * rate), -int(0.05 * rate))
    assert motion.seen(delay).acceleration[inner] == pytest.approx(wanted[inner], abs=2e-3)


def test_acceleration_holds_little_of_the_noise_of_the_motor():
    rng = np.random.default_rng(1)
    time = np.arange(2500) / 250.0
    motion = JointMotion(1, time, rng.normal(0.0, 1e-6, 2500), np.zeros(2500), np.zeros(2500), 250.0, 1.0e6)
    assert np.std(motion.seen().acceleration) < 7e-3
