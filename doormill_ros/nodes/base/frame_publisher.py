"""Frames for viewers, on /tf and /tf_static."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Transform, TransformStamped, Vector3
from std_msgs.msg import Header

from doormill_interfaces.msg import TFMessage
from doormill_ros.arrays import FloatArray
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.convert.geometry import pose_message
from doormill_ros.robot.urdf import LinkPose

PERIOD = 1.0  # s; a viewer that joins late sees the frames on /tf after this


def frame_topics() -> tuple[topics.Topic, topics.Topic]:
    """/tf and /tf_static."""
    message = tf_message_class()
    return (
        topics.Topic("/tf", message, topics.TRANSFORMS, topics.TRANSFORMS),
        topics.Topic("/tf_static", message, topics.STATE, topics.STATE),
    )


class FramePublisher:
    """Frames of one node on /tf, again and again, and on /tf_static, latched; make it in the node's `setup`."""

    def __init__(self, node: ManagedNode) -> None:
        moving, static = frame_topics()
        self._node = node
        self._message: Any = moving.type
        self._moving: dict[str, LinkPose] = {}
        self._static: dict[str, LinkPose] = {}
        self._tf, self._tf_static = node.publisher(moving), node.publisher(static)
        node.every(PERIOD, self._publish)

    def show(self, poses: Iterable[LinkPose]) -> None:
        """Publish frames now and for late joiners; those with the same child take the place of earlier ones."""
        self._moving |= {pose.child: pose for pose in poses}
        self._publish()

    def show_static(self, poses: Iterable[LinkPose]) -> None:
        """Publish frames that stay."""
        self._static |= {pose.child: pose for pose in poses}
        # Latched with depth 1: each message has to hold all of them.
        self._tf_static.publish(self._filled(self._static))

    def _publish(self) -> None:
        if self._moving:
            self._tf.publish(self._filled(self._moving))

    def _filled(self, poses: dict[str, LinkPose]) -> Any:
        now = self._node.get_clock().now().to_msg()
        return self._message(transforms=transform_messages(poses.values(), now))


def tf_message_class() -> Any:
    """tf2_msgs/TFMessage, and where that package is not installed (the wheels have none) ours of the same fields."""
    try:
        return import_module("tf2_msgs.msg").TFMessage
    except ImportError:
        return TFMessage


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
