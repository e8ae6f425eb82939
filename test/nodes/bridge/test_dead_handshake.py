"""A bridge whose handshake has ended by an error of its program says so, with a door in hand too."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.parameter import Parameter

from doormill_interfaces.action import MillDoor
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.process.spinning import SteadyExecutor
from support.waiting import LIMIT, until


def raising(*_: object) -> None:
    raise ZeroDivisionError("on purpose")


def test_it_is_told_as_an_error_while_a_goal_is_in_hand(
    context: rclpy.Context, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended: list[object] = []
    monkeypatch.setattr(threading, "excepthook", ended.append)
    (tmp_path / "home").mkdir()
    # Nobody answers for the recipe, so that the goal stays in hand.
    values = {"address": str(tmp_path / "home"), "archive": str(tmp_path), "limit.recipe": LIMIT}
    bridge = AbbBridge(
        context=context, parameter_overrides=[Parameter(n, value=v) for n, v in values.items()]
    )
    beside = Node("beside", context=context)
    told: list[DiagnosticStatus] = []
    topic = topics.DIAGNOSTICS
    beside.create_subscription(DiagnosticArray, topic.name, lambda m: told.extend(m.status), topic.requested)
    executor = SteadyExecutor(4, context=context)
    executor.add_node(bridge)
    executor.add_node(beside)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    try:
        bridge.bring_up()
        client = ActionClient(beside, MillDoor, "mill_door")
        assert client.wait_for_server(LIMIT)
        stages: list[str] = []
        client.send_goal_async(MillDoor.Goal(door_id="door"), lambda m: stages.append(m.feedback.stage))
        until(lambda: stages)
        assert bridge._loop.alive
        monkeypatch.setattr(bridge.handshake, "_step_cleared", raising)
        until(lambda: ended)
        told.clear()
        until(lambda: [s for s in told if "the handshake ended" in s.message], lambda: str(told[-3:]))
        status = next(s for s in told if "the handshake ended" in s.message)
        assert status.level == DiagnosticStatus.ERROR
        assert "on purpose" in status.message
        assert "restart the bridge" in status.message
    finally:
        bridge.close()
        executor.shutdown(timeout_sec=2.0)
        thread.join(LIMIT)
        client.destroy()
        bridge.destroy_node()
        beside.destroy_node()
