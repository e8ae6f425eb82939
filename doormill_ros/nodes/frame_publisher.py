"""Frames for viewers: on /tf and /tf_static, and one by one where tf2's messages are not installed."""

from __future__ import annotations

from collections.abc import Iterable

from geometry_msgs.msg import TransformStamped

from doormill_ros.nodes import topics
from doormill_ros.nodes.convert.transforms import tf_message_class, transform_messages
from doormill_ros.nodes.managed_node import ManagedNode
from doormill_ros.robot.urdf import LinkPose

PERIOD = 1.0  # s; a viewer that joins late sees the frames on /tf after this


def frame_topics() -> tuple[topics.Topic, ...]:
    """/tf and /tf_static; without tf2_msgs `frames`."""
    message = tf_message_class()
    if message is None:
        return (topics.FRAMES,)
    kinds = (("/tf", topics.TRANSFORMS), ("/tf_static", topics.STATE))
    return tuple(topics.Topic(name, message, qos, qos) for name, qos in kinds)


class FramePublisher:
    """Publishes the frames of one node; says so once when it has to do without tf2_msgs.

    Args:
        node: Owner; make this in its `setup`.
    """

    def __init__(self, node: ManagedNode) -> None:
        self._node = node
        self._moving: dict[str, LinkPose] = {}
        self._static: dict[str, LinkPose] = {}
        used = frame_topics()
        self._message = tf_message_class()
        if self._message is None:
            self._frames = node.publisher(topics.FRAMES)
            node.get_logger().info(
                f"no frames on /tf: tf2_msgs is not installed; topic '{topics.FRAMES.name}' has them instead"
            )
            return
        self._tf, self._tf_static = (node.publisher(topic) for topic in used)
        node.every(PERIOD, self._publish)

    def show(self, poses: Iterable[LinkPose]) -> None:
        """Publish frames now and from now on; those with the same child take the place of earlier ones."""
        added = {pose.child: pose for pose in poses}
        self._moving |= added
        if self._message is None:
            self._publish_singly(added)
        else:
            self._publish()

    def show_static(self, poses: Iterable[LinkPose]) -> None:
        """Publish frames that stay."""
        added = {pose.child: pose for pose in poses}
        self._static |= added
        if self._message is None:
            self._publish_singly(added)
        else:
            # Latched with depth 1: each message has to hold all of them.
            self._tf_static.publish(self._message(transforms=self._filled(self._static)))

    def _publish(self) -> None:
        if self._moving:
            self._tf.publish(self._message(transforms=self._filled(self._moving)))

    def _publish_singly(self, poses: dict[str, LinkPose]) -> None:
        for transform in self._filled(poses):
            self._frames.publish(transform)

    def _filled(self, poses: dict[str, LinkPose]) -> list[TransformStamped]:
        return transform_messages(poses.values(), self._node.get_clock().now().to_msg())
