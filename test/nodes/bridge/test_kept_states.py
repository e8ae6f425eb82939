"""A state of the handshake that was lost on the wire can be sent again: the bridge keeps those of a whole door."""

from __future__ import annotations

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from doormill_interfaces.msg import AbbStatus
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.nodes.base import topics


def test_who_comes_after_a_door_is_told_of_all_its_states(context: rclpy.Context) -> None:
    topic, heard = topics.ABB_STATUS, []
    node = Node("late", context=context)
    publisher = node.create_publisher(topic.type, topic.name, topic.offered)
    states = [state.value for state in HandshakeState]
    for state in states:
        publisher.publish(AbbStatus(state=state))
    everything = QoSProfile(depth=2 * len(states), durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(topic.type, topic.name, lambda status: heard.append(status.state), everything)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    while states[-1] not in heard:
        executor.spin_once(0.05)
    assert heard == states
    executor.shutdown()
    node.destroy_node()
