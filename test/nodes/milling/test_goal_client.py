"""A client that is made while another thread spins its node."""

from __future__ import annotations

from typing import Any

import pytest
import rclpy
from rclpy.action import ActionClient
from rclpy.node import Node

from doormill_interfaces.action import MillDoor
from doormill_ros.nodes.clients.goal_client import GoalClient


class SpunNode(Node):
    """Its executor looks at what is new in the moment in which it comes."""

    def add_waitable(self, waitable: Any) -> None:
        super().add_waitable(waitable)
        waitable.get_num_entities()


@pytest.fixture
def node(context: rclpy.Context):
    node = SpunNode("spun", context=context)
    yield node
    node.destroy_node()


def test_it_is_whole_when_the_executor_sees_it(node: SpunNode) -> None:
    client = GoalClient(node, MillDoor, "mill_door")
    assert not client.server_is_ready()
    client.destroy()


def test_rclpys_own_is_not(node: SpunNode) -> None:
    """If this fails, rclpy has been mended and `GoalClient` may go."""
    with pytest.raises(AttributeError, match="_lock"):
        ActionClient(node, MillDoor, "mill_door")
