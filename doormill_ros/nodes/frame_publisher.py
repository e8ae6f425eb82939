"""Frames for viewers: on /tf and /tf_static, and one by one where tf2's messages are not installed."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from typing import Any, Protocol

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Transform, TransformStamped, Vector3
from std_msgs.msg import Header

from doormill_ros.arrays import FloatArray
from doormill_ros.nodes import topics
from doormill_ros.nodes.convert.geometry import pose_message
from doormill_ros.nodes.managed_node import ManagedNode
from doormill_ros.robot.urdf import LinkPose

PERIOD = 1.0  # s; a viewer that joins late sees the frames on /tf after this


class FramePublisher(Protocol):
    """Publishes the frames of one node."""

    def show(self, poses: Iterable[LinkPose]) -> None:
        """Publish frames now and for late joiners; those with the same child take the place of earlier ones."""

    def show_static(self, poses: Iterable[LinkPose]) -> None:
        """Publish frames that stay."""


def frame_topics() -> tuple[topics.Topic, ...]:
    """/tf and /tf_static; without tf2_msgs `frames`."""
    message = tf_message_class()
    if message is None:
        return (topics.FRAMES,)
    kinds = (("/tf", topics.TRANSFORMS), ("/tf_static", topics.STATE))
    return tuple(topics.Topic(name, message, qos, qos) for name, qos in kinds)


def frame_publisher(node: ManagedNode) -> FramePublisher:
    """What publishes a node's frames with the messages that are installed; make it in the node's `setup`."""
    used = frame_topics()
    return SingleFrames(node) if used == (topics.FRAMES,) else TreeFrames(node, *used)


class TreeFrames:
    """Frames on /tf, again and again, and on /tf_static, latched."""

    def __init__(self, node: ManagedNode, moving: topics.Topic, static: topics.Topic) -> None:
        self._node = node
        self._message: Any = moving.type
        self._moving: dict[str, LinkPose] = {}
        self._static: dict[str, LinkPose] = {}
        self._tf, self._tf_static = node.publisher(moving), node.publisher(static)
        node.every(PERIOD, self._publish)

    def show(self, poses: Iterable[LinkPose]) -> None:
        """See `FramePublisher`."""
        self._moving |= {pose.child: pose for pose in poses}
        self._publish()

    def show_static(self, poses: Iterable[LinkPose]) -> None:
        """See `FramePublisher`."""
        self._static |= {pose.child: pose for pose in poses}
        # Latched with depth 1: each message has to hold all of them.
        self._tf_static.publish(self._filled(self._static))

    def _publish(self) -> None:
        if self._moving:
            self._tf.publish(self._filled(self._moving))

    def _filled(self, poses: dict[str, LinkPose]) -> Any:
        now = self._node.get_clock().now().to_msg()
        return self._message(transforms=transform_messages(poses.values(), now))


class SingleFrames:
    """Frames one by one on a topic of the cell's own, latched; says so once."""

    def __init__(self, node: ManagedNode) -> None:
        self._node = node
        self._frames = node.publisher(topics.FRAMES)
        node.get_logger().info(
            f"no frames on /tf: tf2_msgs is not installed; topic '{topics.FRAMES.name}' has them instead"
        )

    def show(self, poses: Iterable[LinkPose]) -> None:
        """See `FramePublisher`."""
        for transform in transform_messages(poses, self._node.get_clock().now().to_msg()):
            self._frames.publish(transform)

    def show_static(self, poses: Iterable[LinkPose]) -> None:
        """See `FramePublisher`."""
        self.show(poses)


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
