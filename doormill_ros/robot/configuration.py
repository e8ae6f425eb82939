"""RAPID's name for the branch and the turns of a set of joint angles: confdata."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.robot.chain import chain_frames, cross, dot
from doormill_ros.robot.description import Robot

_QUARTER = np.pi / 2.0
_SLACK = 1e-9  # rad or m: rounding noise below a border counts as on it


@dataclass(frozen=True)
class ConfData:
    """RAPID robot configuration of a target: quarter turns of axes 1, 4 and 6, and cfx 0..7."""

    cf1: int
    cf4: int
    cf6: int
    cfx: int


def configurations(robot: Robot, q: FloatArray) -> list[ConfData]:
    """Configurations of many joint angles.

    cf1, cf4 and cf6 count the quarter turns of axes 1, 4 and 6: 0 for [0, 90) deg, -1 for
    [-90, 0) deg. cfx is 4 when the wrist centre is behind axis 1, plus 2 when it is behind the
    lower arm, plus 1 when axis 5 is negative (serial arms of the IRB 6600 kind).

    Args:
        robot: Whose lengths decide cfx.
        q: Joint angles, shape (n, 6) [rad].
    """
    quarters = np.floor((q[:, [0, 3, 5]] + _SLACK) / _QUARTER).astype(int).tolist()
    index = configuration_index(robot, q).tolist()
    return [ConfData(cf1, cf4, cf6, cfx) for (cf1, cf4, cf6), cfx in zip(quarters, index, strict=True)]


def configuration_index(robot: Robot, q: FloatArray) -> IntArray:
    """cfx, shape (n,), of joint angles q, shape (n, 6) [rad]."""
    frames = chain_frames(robot.dh, np.ascontiguousarray(np.asarray(q, dtype=float).T))
    shoulder, elbow, wrist = frames.origin[1], frames.origin[2], frames.origin[4]
    # x of frame 1 without its height: the direction in which axis 1 faces.
    behind_axis_1 = dot(frames.x[1], wrist - frames.origin[0]) < -_SLACK
    bend = dot(cross(elbow - shoulder, wrist - elbow), frames.z[1])
    return 4 * behind_axis_1 + 2 * (bend < -_SLACK) + (q[:, 4] < -_SLACK)
