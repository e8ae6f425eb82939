"""Frames on /tf and /tf_static, where tf2's messages are installed."""

from __future__ import annotations

from collections.abc import Iterable

from doormill_ros.nodes import topics
from doormill_ros.nodes.convert.transforms import tf_message_class, transform_messages
from doormill_ros.nodes.managed_node import ManagedNode
from doormill_ros.robot.urdf import LinkPose

PERIOD = 1.0  # s; a viewer that joins late sees the frames after this


def frame_topics() -> tuple[topics.Topic, ...]:
    """/tf and /tf_static; none without tf2_msgs."""
    message = tf_message_class()
    if message is None:
        return ()
    kinds = (("/tf", topics.TRANSFORMS), ("/tf_static", topics.STATE))
    return tuple(topics.Topic(name, message, qos, qos) for name, qos in kinds)


class FramePublisher:
    """Publishes the frames of one node; without tf2_msgs it says so once and does nothing.

    Args:
        node: Owner; make this in its `setup`.
    """

    def __init__(self, node: ManagedNode) -> None:
        self._node = node
        self._moving: dict[str, LinkPose] = {}
        self._static: dict[str, LinkPose] = {}
        used = frame_topics()
        if not used:
            self._message = None
            node.get_logger().info("no frames on /tf: tf2_msgs is not installed; all else is published")
            return
        self._message = used[0].type
        self._tf, self._tf_static = (node.publisher(topic) for topic in used)
        node.every(PERIOD, self._publish)

    def show(self, poses: Iterable[LinkPose]) -> None:
        """Publish frames now and from now on; those with the same child take the place of earlier ones."""
        self._moving |= {pose.child: pose for pose in poses}
        self._publish()

    def show_static(self, poses: Iterable[LinkPose]) -> None:
        """Publish frames that stay."""
        self._static |= {pose.child: pose for pose in poses}
        if self._message is not None:
            # Latched with depth 1: each message has to hold all of them.
            self._tf_static.publish(self._filled(self._static))

    def _publish(self) -> None:
        if self._message is not None and self._moving:
            self._tf.publish(self._filled(self._moving))

    def _filled(self, poses: dict[str, LinkPose]) -> object:
        stamp = self._node.get_clock().now().to_msg()
        return self._message(transforms=transform_messages(poses.values(), stamp))
