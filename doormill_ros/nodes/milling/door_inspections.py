"""How milled doors came out, as whoever measures them tells it: part of the nodes that take a door through its run."""

from __future__ import annotations

from collections.abc import Callable

from doormill_interfaces.msg import DoorInspection, MilledDoor
from doormill_ros.cell.output.inspection import MeasuredDoor
from doormill_ros.messages.from_message import gauged_of, inspection_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter

GAUGE_PARAMETER = NodeParameter(
    "gauge",
    False,
    "a gauge on door/inspection measures every door, and its run waits for that; where not, the result says so and the "
    "gauge tells later",
)


class DoorInspections:
    """Keeps the latest door that was measured.

    Args:
        node: Owner; make this in its `setup`.
        notify: Called after each door.
        gauge: A gauge measures every door, too. What is measured in the cell counts before that.
    """

    def __init__(self, node: ManagedNode, notify: Callable[[], None], gauge: bool = False) -> None:
        self._node = node
        self._notify = notify
        self._latest = ("", MeasuredDoor())
        self._gauged = ("", MeasuredDoor())
        self._subscriptions = [node.subscribe(topics.MILLED_DOOR, self._take)]
        if gauge:
            self._subscriptions.append(node.subscribe(topics.DOOR_INSPECTION, self._take_gauged))

    @property
    def present(self) -> frozenset[bytes]:
        """Who measures doors, by the ids that DDS gives to publishers."""
        offers = (
            offer
            for subscription in self._subscriptions
            if subscription.get_publisher_count()
            for offer in self._node.get_publishers_info_by_topic(subscription.topic_name)
        )
        return frozenset(bytes(offer.endpoint_gid) for offer in offers)

    def found(self, run_id: str) -> MeasuredDoor | None:
        """How a run's door came out, None while nobody has told."""
        return next((found for of_run, found in (self._latest, self._gauged) if of_run == run_id), None)

    def _take(self, message: MilledDoor) -> None:
        self._latest = (message.run_id, inspection_of(message))
        self._notify()

    def _take_gauged(self, message: DoorInspection) -> None:
        self._gauged = (message.run_id, gauged_of(message))
        self._notify()
