"""Poses, wrenches, twists, times."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, Vector3, Wrench
from nav_msgs.msg import Path
from std_msgs.msg import Header

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import quaternion_xyzw


def pose_message(T_a_b: FloatArray) -> Pose:
    """Pose of b in a from T_a_b, shape (4, 4)."""
    x, y, z, w = (float(v) for v in quaternion_xyzw(T_a_b))
    px, py, pz = (float(v) for v in T_a_b[:3, 3])
    return Pose(position=Point(x=px, y=py, z=pz), orientation=Quaternion(x=x, y=y, z=z, w=w))


def pose_values(T_a_b: Sequence[FloatArray] | FloatArray) -> list[list[float]]:
    """x, y, z, qx, qy, qz, qw of each of many poses, shape (4, 4) each, for `fill_pose`."""
    if len(T_a_b) == 0:
        return []
    stacked = np.array(T_a_b, dtype=float)
    values: list[list[float]] = np.hstack([stacked[:, :3, 3], quaternion_xyzw(stacked)]).tolist()
    return values


def pose_messages(T_a_b: FloatArray) -> list[Pose]:
    """Poses of b in a from many T_a_b, shape (n, 4, 4): all turned to quaternions at once."""
    poses = []
    for values in pose_values(T_a_b):
        pose = Pose()
        fill_pose(pose, values)
        poses.append(pose)
    return poses


def fill_pose(message: Pose, values: list[float]) -> None:
    """Fill a pose in place: generated constructors make every default even where a value is given."""
    p, q = message.position, message.orientation
    p.x, p.y, p.z, q.x, q.y, q.z, q.w = values


def path_message(header: Header, T_a_b: Sequence[FloatArray]) -> Path:
    """A path through many poses, shape (4, 4) each, all with the path's header."""
    path = Path(header=header)
    for values in pose_values(T_a_b):
        stamped = PoseStamped()
        stamped.header = header
        fill_pose(stamped.pose, values)
        path.poses.append(stamped)
    return path


def _vector(values: FloatArray) -> Vector3:
    return Vector3(x=float(values[0]), y=float(values[1]), z=float(values[2]))


def wrench_message(wrench: FloatArray) -> Wrench:
    """Wrench from shape (6,), force first [N, N m]."""
    return Wrench(force=_vector(wrench[:3]), torque=_vector(wrench[3:]))
