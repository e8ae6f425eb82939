"""The bridge tells who measures doors apart from who was started after them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from doormill_interfaces.msg import MilledDoor
from doormill_ros.nodes import topics
from doormill_ros.nodes.door_inspections import DoorInspections
from doormill_ros.nodes.managed_node import ManagedNode

TOPIC = topics.MILLED_DOOR


class Owner(ManagedNode):
    """A node that hears of measured doors and nothing else."""

    def setup(self) -> None:
        self.inspections = DoorInspections(self, lambda: None)


@pytest.fixture
def owner(context: rclpy.Context) -> Iterator[Owner]:
    node = Owner("owner", context=context, cli_args=["--ros-args", "-p", "autostart:=false"])
    node.trigger_configure()
    node.trigger_activate()
    yield node
    node.destroy_node()


def until(node: Owner, condition: Callable[[], bool]) -> None:
    """Turn until a condition holds, for as long as the test is given."""
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    while not condition():
        executor.spin_once(0.05)
    executor.shutdown()


def test_a_gauge_that_is_started_again_is_another(owner: Owner, context: rclpy.Context) -> None:
    assert owner.inspections.present == frozenset()
    gauge = Node("gauge", context=context)
    first = gauge.create_publisher(TOPIC.type, TOPIC.name, TOPIC.offered)
    until(owner, lambda: len(owner.inspections.present) == 1)
    before = owner.inspections.present
    second = gauge.create_publisher(TOPIC.type, TOPIC.name, TOPIC.offered)
    until(owner, lambda: len(owner.inspections.present) == 2)
    assert before < owner.inspections.present
    gauge.destroy_publisher(first)
    until(owner, lambda: len(owner.inspections.present) == 1)
    assert before.isdisjoint(owner.inspections.present)
    second.publish(MilledDoor(run_id="r1"))
    until(owner, lambda: owner.inspections.found("r1") is not None)
    gauge.destroy_node()
    until(owner, lambda: owner.inspections.present == frozenset())
