"""Poses, wrenches, twists, times."""

from __future__ import annotations

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3, Wrench

from doormill_ros.frames import quaternion_xyzw
from doormill_ros.recording.messages import nanoseconds_of, transform_of, twist_of, wrench_of

__all__ = [
    "nanoseconds_of",
    "pose_message",
    "seconds_of",
    "transform_of",
    "twist_message",
    "twist_of",
    "wrench_message",
    "wrench_of",
]


def pose_message(T_a_b: np.ndarray) -> Pose:
    """Pose of b in a from T_a_b, shape (4, 4)."""
    x, y, z, w = (float(v) for v in quaternion_xyzw(T_a_b))
    px, py, pz = (float(v) for v in T_a_b[:3, 3])
    return Pose(position=Point(x=px, y=py, z=pz), orientation=Quaternion(x=x, y=y, z=z, w=w))


def _vector(values: np.ndarray) -> Vector3:
    return Vector3(x=float(values[0]), y=float(values[1]), z=float(values[2]))


def wrench_message(wrench: np.ndarray) -> Wrench:
    """Wrench from shape (6,), force first [N, N m]."""
    return Wrench(force=_vector(wrench[:3]), torque=_vector(wrench[3:]))


def twist_message(twist: np.ndarray) -> Twist:
    """Small displacement from shape (6,), translation first [m, rad]."""
    return Twist(linear=_vector(twist[:3]), angular=_vector(twist[3:]))


def seconds_of(stamp: Time) -> float:
    """Seconds since the epoch."""
    return stamp.sec + 1e-9 * stamp.nanosec
