"""Frames for tf2."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Transform, TransformStamped, Vector3
from std_msgs.msg import Header

from doormill_ros.arrays import FloatArray
from doormill_ros.nodes.convert.geometry import pose_message
from doormill_ros.robot.urdf import LinkPose


def tf_message_class() -> Any:
    """tf2_msgs/TFMessage, None where that package is not installed: the wheels have none."""
    try:
        return import_module("tf2_msgs.msg").TFMessage
    except ImportError:
        return None


def transform_message(parent: str, child: str, T_parent_child: FloatArray, stamp: Time) -> TransformStamped:
    """Frame `child` in frame `parent`; T_parent_child has shape (4, 4)."""
    pose = pose_message(T_parent_child)
    translation = Vector3(x=pose.position.x, y=pose.position.y, z=pose.position.z)
    return TransformStamped(
        header=Header(stamp=stamp, frame_id=parent),
        child_frame_id=child,
        transform=Transform(translation=translation, rotation=pose.orientation),
    )


def transform_messages(poses: Iterable[LinkPose], stamp: Time) -> list[TransformStamped]:
    """One message for each frame."""
    return [transform_message(pose.parent, pose.child, pose.T_parent_child, stamp) for pose in poses]
