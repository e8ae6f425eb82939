"""How far joint angles are from the three singularities of an arm with a spherical wrist."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.chain import chain_frames, cross, dot
from doormill_ros.robot.description import Robot


@dataclass(frozen=True, eq=False)
class Clearance:
    """Distances from singularity, each shape (n,), never negative.

    Attributes:
        wrist: Angle between axes 4 and 6 [rad].
        elbow: Angle between lower arm and the line from elbow to wrist centre, stretched or folded [rad].
        shoulder: Distance of the wrist centre from axis 1 [m].
    """

    wrist: FloatArray
    elbow: FloatArray
    shoulder: FloatArray


def clearance(robot: Robot, q: FloatArray) -> Clearance:
    """Clearance of joint angles q, shape (n, 6) [rad]."""
    frames = chain_frames(robot.dh, np.ascontiguousarray(np.asarray(q, dtype=float).T))
    lower_arm = frames.origin[2] - frames.origin[1]
    forearm = frames.origin[4] - frames.origin[2]
    wrist_centre = frames.origin[4] - frames.origin[0]
    return Clearance(
        wrist=line_angle(frames.z[3], frames.z[5]),
        elbow=line_angle(lower_arm, forearm),
        shoulder=np.hypot(dot(frames.x[0], wrist_centre), dot(frames.y[0], wrist_centre)),
    )


def line_angle(a: FloatArray, b: FloatArray) -> FloatArray:
    """Angle between two lines, 0 to 90 degrees, shapes (3, n) to (n,)."""
    normal = cross(a, b)
    return np.arctan2(np.sqrt(dot(normal, normal)), np.abs(dot(a, b)))
