"""A robot, and plain forward kinematics that shares no code with ours."""

import math

import numpy as np
import pytest

from doormill_ros.robot.description import load_robot

# Table 2.1 of the thesis: theta_offset, d, a, alpha.
TABLE_2_1 = [
    [0.0, 0.780, 0.320, -math.pi / 2],
    [-math.pi / 2, 0.0, 1.075, 0.0],
    [0.0, 0.0, 0.200, -math.pi / 2],
    [0.0, 1.142, 0.0, math.pi / 2],
    [0.0, 0.0, 0.0, -math.pi / 2],
    [math.pi, 0.200, 0.0, 0.0],
]


def plain_link(q, link=6):
    """T_base_link by multiplying Rz Tz Tx Rx, one row of the table after the other."""
    T = np.eye(4)
    for (offset, d, a, alpha), angle in list(zip(TABLE_2_1, q, strict=True))[:link]:
        c, s = math.cos(angle + offset), math.sin(angle + offset)
        ca, sa = math.cos(alpha), math.sin(alpha)
        T = T @ np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, d], [0, 0, 0, 1.0]])
        T = T @ np.array([[1, 0, 0, a], [0, ca, -sa, 0], [0, sa, ca, 0], [0, 0, 0, 1.0]])
    return T


@pytest.fixture(scope="session")
def irb6600():
    return load_robot("irb6600_175_255")


@pytest.fixture(scope="session")
def link_pose():
    return plain_link


@pytest.fixture
def configurations(irb6600):
    def draw(n, seed):
        return np.random.default_rng(seed).uniform(irb6600.lower, irb6600.upper, (n, 6))

    return draw
