"""Listen to the cell and tell whether it can take a door."""

from __future__ import annotations

import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from doormill_ros.cell.graph.door_sensors import chosen_sensors
from doormill_ros.cell.graph.node_names import DOOR_SHARES
from doormill_ros.cell.graph.readiness import OF_A_ROBOT, Readiness, needed_nodes
from doormill_ros.cell.graph.two_robots import in_robot
from doormill_ros.cell.places.layout import CAMERA, load_layout
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.robots import ROBOTS

PERIOD = 0.1  # s


def listen(namespace: str, limit: float, robots: int = 1) -> list[str]:
    """What hinders the cell of a namespace, once it is ready or the limit is over; empty when it is ready.

    Args:
        namespace: Such as "/cell1"; empty: none.
        limit: Longest wait [s].
        robots: 2 for two of them at one door.
    """
    sensors = chosen_sensors(load_layout())
    needed = needed_nodes(sensors)
    readiness = Readiness(needed if robots == 1 else _of_two(needed))
    prefix = f"{namespace.strip('/')}/".lstrip("/")

    def take(array: DiagnosticArray) -> None:
        for status in array.status:
            name = status.name.lstrip("/")
            if status.hardware_id == "doormill" and name.startswith(prefix):
                readiness.hear(name.removeprefix(prefix), ord(status.level), status.message)

    rclpy.init(args=["health"])
    node = Node(
        "cell_health", namespace=namespace or None, enable_rosout=False, start_parameter_services=False
    )
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    # A cell in a namespace has /diagnostics in it, where launched so.
    for topic in {topics.DIAGNOSTICS.name, node.resolve_topic_name(topics.DIAGNOSTICS.name.lstrip("/"))}:
        node.create_subscription(topics.DIAGNOSTICS.type, topic, take, topics.DIAGNOSTICS.requested)
    drivers = [
        (node.resolve_topic_name(topic.name), there)
        for topic, there in ((topics.IMAGE, CAMERA in sensors), (topics.SENSOR_READING, sensors != (CAMERA,)))
    ]
    end = time.monotonic() + limit
    try:
        while True:
            executor.spin_once(timeout_sec=PERIOD)
            offered = [not there or node.count_publishers(name) > 0 for name, there in drivers]
            found = readiness.hindrances(*offered)
            if not found or time.monotonic() > end:
                return found
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()


def _of_two(needed: tuple[str, ...]) -> tuple[str, ...]:
    """The nodes that two robots need, from those that one needs."""
    own = (f"{in_robot(robot)}/{name}" for robot in ROBOTS for name in needed if name in OF_A_ROBOT)
    return (*(name for name in needed if name not in OF_A_ROBOT), DOOR_SHARES, *own)
