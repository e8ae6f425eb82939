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
        self._notify = notify
        self._latest = ("", MeasuredDoor())
        self._subscription = node.subscribe(topics.MILLED_DOOR, self._take)

    @property
    def present(self) -> bool:
        """Somebody measures doors."""
        return int(self._subscription.get_publisher_count()) > 0

    def found(self, run_id: str) -> MeasuredDoor | None:
        """How a run's door came out, None while nobody has told."""
        of_run, inspection = self._latest
        return inspection if of_run == run_id else None

    def _take(self, message: MilledDoor) -> None:
        self._latest = (message.run_id, inspection_of(message))
        self._notify()
