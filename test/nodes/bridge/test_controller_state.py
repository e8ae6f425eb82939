"""How the controller is, as the bridge tells it, and that no file is announced where its state forbids it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.parameter import Parameter

from doormill_interfaces.msg import ControllerState, TargetArray
from doormill_ros.abb import signals
from doormill_ros.abb.link_errors import ControllerStateError
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.base import topics
from doormill_ros.simulation.controller.operation.panel import ControlPanel
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.waiting import LIMIT


class Listener:
    """A bridge on simulated web services, and what it tells."""

    def __init__(self, server: RwsServer, context: rclpy.Context, tmp_path: Path) -> None:
        self.server = server
        self.states: list[ControllerState] = []
        self.levels: list[tuple[bytes, str]] = []
        parameters = {"transport": "rws1", "address": server.url, "archive": str(tmp_path / "targets")}
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        self.bridge = AbbBridge(context=context, parameter_overrides=overrides)
        topic = topics.CONTROLLER_STATE
        self.bridge.create_subscription(topic.type, topic.name, self.states.append, topic.requested)
        topic = topics.DIAGNOSTICS
        self.bridge.create_subscription(topic.type, topic.name, self._take, topic.requested)
        self.executor = SingleThreadedExecutor(context=context)
        self.executor.add_node(self.bridge)
        assert self.bridge.trigger_configure() == TransitionCallbackReturn.SUCCESS
        assert self.bridge.trigger_activate() == TransitionCallbackReturn.SUCCESS

    def _take(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name == "abb_bridge/controller":
                self.levels.append((status.level, status.message))

    @property
    def panel(self) -> ControlPanel:
        return self.server.cabinet.idle.panel

    def until(self, condition: Callable[[], object]) -> None:
        limit = time.monotonic() + LIMIT
        while not condition():
            assert time.monotonic() < limit, (self.states[-1:], self.levels[-1:])
            self.executor.spin_once(timeout_sec=0.05)


@pytest.fixture
def listener(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Listener]:
    monkeypatch.setenv("DOORMILL_CONTROLLER_USER", "Default User")
    monkeypatch.setenv("DOORMILL_CONTROLLER_PASSWORD", "robotics")
    context = rclpy.Context()
    rclpy.init(context=context)
    with RwsServer(Cabinet.create(tmp_path / "home"), 1) as server:
        found = Listener(server, context, tmp_path)
        yield found
        found.bridge.close()
        found.executor.shutdown()
        found.bridge.destroy_node()
    rclpy.shutdown(context=context)


def test_an_emergency_stop_is_told_with_what_to_do_and_keeps_files_back(listener: Listener) -> None:
    listener.until(lambda: listener.states and listener.states[-1].takes_files)
    assert listener.states[-1].operating_mode == "AUTO"
    assert listener.states[-1].motors_on
    assert listener.states[-1].speed_override == pytest.approx(1.0)
    listener.panel.emergency_stop()
    listener.until(lambda: listener.states[-1].emergency_stop)
    told = listener.states[-1]
    assert (told.takes_files, told.error_code) == (False, ControllerStateError.code)
    assert "release it" in told.advice
    assert [(event.code, event.severity) for event in told.events] == [(10013, 3)]
    listener.until(lambda: listener.levels[-1] == (DiagnosticStatus.ERROR, told.advice))
    listener.server.cabinet.set_value(signals.REQUEST, 1)
    with pytest.raises(ControllerStateError, match="emergency stop"):
        listener.bridge.submit(TargetArray(run_id="run", door_id="door", accepted=True), 1)
    assert not (listener.server.cabinet.home / signals.TARGET_FILE).exists()
    listener.panel.release_emergency_stop()
    listener.panel.motors(True)
    listener.until(lambda: listener.states[-1].takes_files)
    listener.until(lambda: listener.levels[-1][0] == DiagnosticStatus.OK)


def test_a_slow_override_takes_files_and_warns_of_small_chips(listener: Listener) -> None:
    listener.until(lambda: listener.levels and listener.levels[-1] == (DiagnosticStatus.OK, "takes files"))
    listener.panel.set_speed_override(10.0)
    listener.until(lambda: listener.levels[-1][0] == DiagnosticStatus.WARN)
    assert "the speed override is 10 %" in listener.levels[-1][1]
    assert listener.states[-1].takes_files
    listener.panel.set_speed_override(100.0)
    listener.until(lambda: listener.levels[-1] == (DiagnosticStatus.OK, "takes files"))


def test_a_controller_that_cannot_be_asked_is_an_error(listener: Listener) -> None:
    listener.until(lambda: listener.states and listener.states[-1].takes_files)
    stopped = threading.Thread(target=listener.server.stop)
    stopped.start()
    listener.until(lambda: listener.states[-1].error_code not in (0, ControllerStateError.code))
    stopped.join()
    assert not listener.states[-1].takes_files
    listener.until(lambda: listener.levels[-1][0] == DiagnosticStatus.ERROR)
