"""Robots, and a plain implementation of the thesis' kinematics that shares no code with ours."""

import math

import numpy as np
import pytest

from doormill_ros.robot.description import load_robot

# Table 2.1 of the thesis, row by row: theta_offset, d, a, alpha.
TABLE_2_1 = [
    [0.0, 0.780, 0.320, -math.pi / 2],
    [-math.pi / 2, 0.0, 1.075, 0.0],
    [0.0, 0.0, 0.200, -math.pi / 2],
    [0.0, 1.142, 0.0, math.pi / 2],
    [0.0, 0.0, 0.0, -math.pi / 2],
    [math.pi, 0.200, 0.0, 0.0],
]


def _rot_z(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def _rot_x(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1.0]])


def _trans(x, z):
    return np.array([[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, z], [0, 0, 0, 1.0]])


def plain_frames(table, q):
    """T_base_0 .. T_base_6 by multiplying the thesis' elementary matrices (section 2.1.1)."""
    frames = [np.eye(4)]
    for (theta_offset, d, a, alpha), angle in zip(table, q, strict=True):
        step = _rot_z(angle + theta_offset) @ _trans(0, d) @ _trans(a, 0) @ _rot_x(alpha)
        frames.append(frames[-1] @ step)
    return frames


@pytest.fixture(scope="session")
def frames_of():
    return plain_frames


@pytest.fixture(scope="session")
def table_2_1():
    return np.array(TABLE_2_1)


@pytest.fixture(scope="session")
def irb6600():
    return load_robot("irb6600_175_255")


@pytest.fixture(scope="session", params=["irb6600_175_255", "irb6700_235_265"])
def robot(request):
    return load_robot(request.param)
