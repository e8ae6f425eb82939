"""RAPID configuration of one posture."""

from __future__ import annotations

import numpy as np

from doormill_ros.robot.configuration import ConfData, configurations
from doormill_ros.robot.description import Robot


def conf_data(q: np.ndarray, robot: Robot) -> ConfData:
    """Configuration of joint angles, shape (6,) [rad]."""
    return configurations(robot, np.asarray(q, dtype=float)[None])[0]
