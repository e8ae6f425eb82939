"""A goal that ends while its process is being stopped."""

from __future__ import annotations

import threading
from typing import Any

import pytest
import rclpy
from rclpy.action import CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from doormill_interfaces.action import MillDoor
from doormill_ros.nodes.clients.goal_client import GoalClient
from doormill_ros.nodes.milling.action_server import MillDoorActionServer
from doormill_ros.pipeline.run_end import RunEnd
from support.waiting import LIMIT


def test_it_is_closed_without_an_error_where_nobody_can_hear_of_it() -> None:
    """rclpy closes the goal and tells of it; the second fails as the context is gone."""
    context = rclpy.Context()
    rclpy.init(context=context)
    node = Node("ended_goals", context=context)
    taken, stopped, said = threading.Event(), threading.Event(), []

    def execute(goal: Any) -> MillDoor.Result:
        taken.set()
        assert stopped.wait(LIMIT)
        end = RunEnd("r1", "oak")
        end.refuse(803, "the cell stops")
        with pytest.raises(rclpy_implementation.RCLError):
            goal.publish_feedback(MillDoor.Feedback(stage="recipe"))  # what the goal would be told by
        said.append(server.end(goal, end))
        return said[0]

    server = MillDoorActionServer(node, execute, lambda _: CancelResponse.ACCEPT, ReentrantCallbackGroup())
    client = GoalClient(node, MillDoor, "mill_door")
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)

    def spin() -> None:
        while not said and context.ok():
            executor.spin_once(timeout_sec=0.1)

    assert client.wait_for_server(LIMIT)
    client.send_goal_async(MillDoor.Goal(door_id="oak"))
    thread = threading.Thread(target=spin, daemon=True)
    thread.start()
    assert taken.wait(LIMIT)
    rclpy.shutdown(context=context)
    stopped.set()
    thread.join(LIMIT)
    assert [(result.error_code, result.success) for result in said] == [(803, False)]
