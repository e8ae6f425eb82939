"""Part of /abb_bridge: how milled doors came out, as whoever measures them tells it."""

from __future__ import annotations

from collections.abc import Callable

from doormill_interfaces.msg import MilledDoor
from doormill_ros.cell.inspection import MeasuredDoor
from doormill_ros.messages.from_message import inspection_of
from doormill_ros.nodes import topics
from doormill_ros.nodes.managed_node import ManagedNode


class DoorInspections:
    """Keeps the latest door that was measured.

    Args:
        node: Owner; make this in its `setup`.
        notify: Called after each door.
    """

    def __init__(self, node: ManagedNode, notify: Callable[[], None]) -> None:
        self._node = node
        self._notify = notify
        self._latest = ("", MeasuredDoor())
        self._subscription = node.subscribe(topics.MILLED_DOOR, self._take)

    @property
    def present(self) -> frozenset[bytes]:
        """Who measures doors, by the ids that DDS gives to publishers."""
        if not self._subscription.get_publisher_count():
            return frozenset()
        offers = self._node.get_publishers_info_by_topic(self._subscription.topic_name)
        return frozenset(bytes(offer.endpoint_gid) for offer in offers)

    def found(self, run_id: str) -> MeasuredDoor | None:
        """How a run's door came out, None while nobody has told."""
        of_run, inspection = self._latest
        return inspection if of_run == run_id else None

    def _take(self, message: MilledDoor) -> None:
        self._latest = (message.run_id, inspection_of(message))
        self._notify()
