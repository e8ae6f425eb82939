"""Every solution of the inverse kinematics: the branches with every extra turn that the limits allow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.description import Robot
from doormill_ros.robot.inverse import inverse_branches

_TURN = 2.0 * np.pi
_LIMIT_SLACK = 1e-9  # rad; a pose computed at a limit must not be lost to rounding


@dataclass(frozen=True, eq=False)
class Solutions:
    """All solutions of many poses.

    Attributes:
        q: Joint angles within the limits, shape (m, 6) [rad].
        pose: Index of the pose that each row solves, ascending, shape (m,).
        branch: Branch 0..7 of each row, ascending within a pose, shape (m,).
    """

    q: FloatArray
    pose: IntArray
    branch: IntArray


def inverse(robot: Robot, T_base_flange: FloatArray) -> FloatArray:
    """All joint angles within the limits that reach one pose, shape (n, 6) [rad].

    Empty, shape (0, 6), when the pose is out of reach or beyond the limits. At a wrist
    singularity axes 4 and 6 turn about one line; axis 4 is then given as zero or a half turn.

    Args:
        robot: The robot.
        T_base_flange: The pose, shape (4, 4).

    Raises:
        GeometryError: The robot has no closed-form inverse here.
    """
    return inverse_all(robot, np.asarray(T_base_flange, dtype=float)[None]).q


def inverse_all(robot: Robot, T_base_flange: FloatArray) -> Solutions:
    """All joint angles within the limits that reach each of many poses.

    Args:
        robot: The robot.
        T_base_flange: Poses, shape (n, 4, 4).

    Raises:
        GeometryError: The robot has no closed-form inverse here.
    """
    branches = inverse_branches(robot, T_base_flange)
    pose: IntArray
    branch: IntArray
    pose, branch = np.nonzero(np.isfinite(branches[..., 0]))
    q = branches[pose, branch]
    for joint in range(JOINTS):
        q, pose, branch = _with_turns(robot, joint, q, pose, branch)
    return Solutions(q, pose, branch)


def _with_turns(
    robot: Robot, joint: int, q: FloatArray, pose: IntArray, branch: IntArray
) -> tuple[FloatArray, IntArray, IntArray]:
    """Repeat the rows for each whole turn of a joint that lands within its limits."""
    low, high = robot.lower[joint] - _LIMIT_SLACK, robot.upper[joint] + _LIMIT_SLACK
    turns = np.arange(np.floor((low + np.pi) / _TURN), np.ceil((high - np.pi) / _TURN) + 1) * _TURN
    angle = q[:, joint, None] + turns
    # Row by row, so that the rows stay in the order of poses and branches.
    row, column = np.nonzero((angle >= low) & (angle <= high))
    q = q[row]
    q[:, joint] = angle[row, column]
    return q, pose[row], branch[row]
