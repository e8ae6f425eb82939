"""Part of /abb_bridge: how the controller is, on a topic and in diagnostics, and whether it can take a file."""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping

from std_msgs.msg import Header

from doormill_interfaces.msg import ControllerEvent as EventMessage
from doormill_interfaces.msg import ControllerState
from doormill_ros.abb.controller_state import (
    EMERGENCY_STOP,
    GUARD_STOP,
    MOTORS_ON,
    ControllerEvent,
    ControllerReading,
    ControllerWatch,
)
from doormill_ros.abb.link_errors import ControllerStateError, LinkError
from doormill_ros.abb.transport import Transport
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.looking_thread import LookingThread
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.reporting_node import ERROR, OK, WARN
from doormill_ros.nodes.convert.diagnostics import diagnostics

PERIOD = 1.0  # s, between two looks
#: A reading older than this is taken anew before a file is announced [s].
FRESH = 2.0


class ControllerMonitor:
    """Looks at the controller from a thread of its own; without a transport that can tell, it does nothing."""

    def __init__(self, node: ManagedNode, transport: Transport, ask_privilege: bool) -> None:
        """Create the publishers.

        Args:
            node: The bridge.
            transport: Way to the controller.
            ask_privilege: In manual mode ask the operator to let the PC write.
        """
        self._node = node
        self._watch = transport if isinstance(transport, ControllerWatch) else None
        self._ask = ask_privilege
        self._state = node.publisher(topics.CONTROLLER_STATE)
        self._diagnostics = node.publisher(topics.DIAGNOSTICS)
        self._thread = LookingThread(self._run, "controller-monitor")
        self._latest: tuple[float, ControllerReading] | None = None
        self._shown: tuple[ControllerReading | None, str] | None = None

    def start(self) -> None:
        """Begin to look."""
        if self._watch is not None:
            self._thread.start()

    def stop(self) -> None:
        """Cease to look."""
        self._thread.stop()

    def require_fit(self) -> None:
        """Refuse to announce a file to a controller that cannot take it.

        Raises:
            ControllerStateError: Says what hinders and what to do.
            LinkError: Its state cannot be read.
        """
        if self._watch is None:
            return
        latest = self._latest
        if latest is None or latest[1].hindrance or time.monotonic() - latest[0] > FRESH:
            latest = self._look(self._watch)
        latest[1].require_fit()

    def _run(self, ended: threading.Event) -> None:
        tell = self._node.guarded(self._tell)
        while not ended.is_set():
            tell(self._watch)
            ended.wait(PERIOD)

    def _tell(self, watch: ControllerWatch) -> None:
        try:
            _, reading = self._look(watch)
            self._publish(reading, watch.read_events())
        except LinkError as error:
            self._publish_failure(error)

    def _look(self, watch: ControllerWatch) -> tuple[float, ControllerReading]:
        latest = (time.monotonic(), watch.read_controller(self._ask))
        self._latest = latest
        return latest

    def _publish(self, reading: ControllerReading, events: tuple[ControllerEvent, ...]) -> None:
        hindrance = reading.hindrance
        stopped = reading.controller_state in (EMERGENCY_STOP, GUARD_STOP, "sysfail")
        level = ERROR if stopped else WARN if hindrance or reading.caution else OK
        code = ControllerStateError.code if hindrance else 0
        self._diagnose(level, hindrance or reading.caution or "takes files", code, vars(reading))
        if (reading, "") == self._shown and not events:
            return
        self._shown = (reading, "")
        self._send(
            ControllerState(
                operating_mode=reading.operating_mode,
                controller_state=reading.controller_state,
                execution_state=reading.execution_state,
                motors_on=reading.controller_state == MOTORS_ON,
                guard_stop=reading.controller_state == GUARD_STOP,
                emergency_stop=reading.controller_state == EMERGENCY_STOP,
                privilege=reading.privilege,
                speed_override=reading.speed_override,
                takes_files=not hindrance,
                advice=hindrance,
                error_code=code,
                events=[
                    EventMessage(
                        number=event.number,
                        severity=event.severity,
                        code=event.code,
                        title=event.title,
                        text=event.text,
                    )
                    for event in events
                ],
            )
        )

    def _publish_failure(self, error: LinkError) -> None:
        self._latest = None
        self._diagnose(ERROR, f"the controller's state cannot be read: {error.message}", error.code, {})
        if self._shown == (None, error.message):
            return
        self._shown = (None, error.message)
        self._send(ControllerState(advice=error.message, error_code=error.code))

    def _send(self, message: ControllerState) -> None:
        if self._node.context.ok():
            message.header = Header(stamp=self._node.get_clock().now().to_msg())
            self._state.publish(message)

    def _diagnose(self, level: bytes, message: str, error_code: int, figures: Mapping[str, object]) -> None:
        if not self._node.context.ok():
            return
        name, stamp = (
            f"{self._node.get_fully_qualified_name()}/controller",
            self._node.get_clock().now().to_msg(),
        )
        values = {"error_code": error_code, **figures}
        self._diagnostics.publish(diagnostics(name, level, message, values, stamp))
