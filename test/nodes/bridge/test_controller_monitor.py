"""What the bridge tells of its controller: with codes, and after a look at it failed in a way that nobody foresaw."""

from __future__ import annotations

import threading
from types import SimpleNamespace

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticStatus

from doormill_interfaces.msg import ControllerState
from doormill_ros.abb.controller_state import ControllerEvent, ControllerReading
from doormill_ros.abb.link_errors import ControllerStateError, LinkError, LoginError
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.bridge import controller_monitor
from doormill_ros.nodes.bridge.controller_monitor import ControllerMonitor
from doormill_ros.nodes.process.spinning import SteadyExecutor
from support.waiting import LIMIT


class Stumbling:
    """A way to a controller that answers, and that stumbles over its own feet the first time it is asked for events."""

    def __init__(self) -> None:
        self.looks = 0

    def read_controller(self, ask_privilege: bool = False) -> ControllerReading:
        return ControllerReading("AUTO", "motoron", "running", 1.0, ask_privilege)

    def read_events(self) -> tuple[ControllerEvent, ...]:
        self.looks += 1
        if self.looks == 1:
            raise KeyError("nobody foresaw it")
        return (ControllerEvent(self.looks, 1, 10011, "Motors ON state", "on"),)


def test_a_look_that_nobody_foresaw_costs_no_later_one(context: rclpy.Context, monkeypatch) -> None:
    monkeypatch.setattr(controller_monitor, "PERIOD", 0.05)
    node = ManagedNode("bridge", context=context)
    heard, told = threading.Event(), []

    def hear(message: ControllerState) -> None:
        told.append(message)
        heard.set()

    executor = SteadyExecutor(2, context=context)
    executor.add_node(node)
    spinning = threading.Thread(target=executor.spin, daemon=True)
    spinning.start()
    topic = topics.CONTROLLER_STATE
    node.create_subscription(topic.type, topic.name, hear, topic.requested)
    monitor = ControllerMonitor(node, Stumbling(), False)
    monitor.start()
    try:
        assert heard.wait(LIMIT)
        assert told[0].takes_files
        assert told[0].events[0].code == 10011
    finally:
        monitor.stop()
        executor.shutdown()
        spinning.join(LIMIT)
        node.destroy_node()


class Stopped(Stumbling):
    """A controller in emergency stop, or none that answers."""

    def __init__(self, error: LinkError | None) -> None:
        super().__init__()
        self.error = error

    def read_controller(self, ask_privilege: bool = False) -> ControllerReading:
        if self.error is not None:
            raise self.error
        return ControllerReading("AUTO", "emergencystop", "stopped", 1.0, ask_privilege)

    def read_events(self) -> tuple[ControllerEvent, ...]:
        return ()


@pytest.mark.parametrize(
    ("error", "code"), [(None, ControllerStateError.code), (LoginError("no such user"), LoginError.code)]
)
def test_what_keeps_the_controller_from_milling_is_told_with_its_code(
    context: rclpy.Context, error: LinkError | None, code: int
) -> None:
    node = ManagedNode("bridge", context=context)
    told: list[DiagnosticStatus] = []
    monitor = ControllerMonitor(node, Stopped(error), False)
    monitor._diagnostics = SimpleNamespace(publish=lambda array: told.extend(array.status))
    try:
        monitor._tell(monitor._watch)
        assert [status.level for status in told] == [DiagnosticStatus.ERROR]
        assert {pair.key: pair.value for pair in told[0].values}["error_code"] == str(code)
    finally:
        node.destroy_node()
