"""The bridge tells who measures doors apart from who was started after them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from doormill_interfaces.msg import DoorInspection, MilledDoor
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.milling.door_inspections import GAUGE_PARAMETER, DoorInspections

TOPIC = topics.MILLED_DOOR


class Owner(ManagedNode):
    """A node that hears of measured doors and nothing else."""

    PARAMETERS = (GAUGE_PARAMETER,)

    def setup(self) -> None:
        self.inspections = DoorInspections(self, lambda: None, self.value(GAUGE_PARAMETER.name))


@pytest.fixture
def gauged() -> bool:
    return False


@pytest.fixture
def owner(context: rclpy.Context, gauged: bool) -> Iterator[Owner]:
    node = Owner(
        "owner",
        context=context,
        cli_args=["--ros-args", "-p", "autostart:=false", "-p", f"gauge:={str(gauged).lower()}"],
    )
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


@pytest.mark.parametrize("gauged", [True, False])
def test_an_inspection_counts_where_a_gauge_measures_every_door(
    owner: Owner, context: rclpy.Context, gauged: bool
) -> None:
    gauge = Node("gauge", context=context)
    inspections = gauge.create_publisher(
        topics.DOOR_INSPECTION.type, topics.DOOR_INSPECTION.name, topics.DOOR_INSPECTION.offered
    )
    doors = gauge.create_publisher(TOPIC.type, TOPIC.name, TOPIC.offered)
    until(owner, lambda: len(owner.inspections.present) == 1 + gauged)
    for run_id, deviation in (("r1", 1.6e-3), ("r2", -2e-4)):
        inspections.publish(
            DoorInspection(run_id=run_id, feature=["hinge_1", "hinge_2"], deviation=[deviation, 1e-4])
        )
    doors.publish(MilledDoor(run_id="r0"))
    until(owner, lambda: owner.inspections.found("r0") is not None)
    if gauged:
        until(owner, lambda: owner.inspections.found("r2") is not None)
        found = owner.inspections.found("r2")
        assert found is not None
        assert (found.feature, found.deviation, found.out_of_tolerance) == ("hinge_1", 2e-4, False)
        # What is measured in the cell counts before a gauge.
        doors.publish(MilledDoor(run_id="r2"))
        until(owner, lambda: owner.inspections.found("r2") != found)
    assert owner.inspections.found("r1") is None  # of the latest alone is asked
    gauge.destroy_node()
