"""A joint that goes round several times tells its waves to a fraction of an order."""

import numpy as np
import pytest

from doormill_ros.diagnosis.motion.orders import wave_candidates
from doormill_ros.diagnosis.motion.problem import JointProblem
from doormill_ros.robot_model.motion.view import JointMotion

STIFFNESS = 1.0e6


@pytest.mark.parametrize("order", [31.25, 50.0, 77.5, 120.75])
def test_waves_of_a_joint_that_turns_and_turns_are_found(order):
    rng = np.random.default_rng(4)
    time = np.arange(6000) / 250.0
    motor = 13.0 * np.sin(0.4 * time)
    torque = 300.0 * np.sin(0.4 * time + 1.0)
    link = motor - torque / STIFFNESS + 5e-5 * np.sin(order * motor) + rng.normal(0.0, 2e-6, len(time))
    problem = JointProblem([JointMotion(6, time, motor, link, torque, 250.0, STIFFNESS)], (None, None, None))
    found = wave_candidates(problem, problem.fit(()))
    width = 2.0 * np.pi / np.ptp(motor)
    assert width < 0.25
    assert min(abs(wave.order - order) for wave in found) < width
