"""The path generator's node in a context of its own, with its targets kept instead of sent."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import rclpy
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.parameter import Parameter

from doormill_interfaces.msg import TargetArray
from doormill_ros.nodes.path_generator import PathGenerator


class Published:
    """Takes the place of the targets' publisher."""

    def __init__(self) -> None:
        self.messages: list[TargetArray] = []

    def publish(self, message: TargetArray) -> None:
        self.messages.append(message)


@contextmanager
def active_generator(**parameters: object) -> Iterator[PathGenerator]:
    """The active node with these parameters."""
    context = rclpy.Context()
    rclpy.init(context=context)
    told = [Parameter(name, value=value) for name, value in parameters.items()]
    node = PathGenerator(context=context, parameter_overrides=told)
    assert node.trigger_configure() == TransitionCallbackReturn.SUCCESS
    assert node.trigger_activate() == TransitionCallbackReturn.SUCCESS
    node._targets = Published()
    yield node
    node.destroy_node()
    rclpy.shutdown(context=context)
