"""An action server that can fall silent and speak again while its node goes on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import CallbackGroup
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from doormill_interfaces.action import MillDoor
from doormill_ros.nodes.convert.run_end import run_end_into
from doormill_ros.pipeline.run_end import RunEnd


class QuietActionServer(ActionServer):  # type: ignore[misc]  # rclpy has no types
    """Leaves goals to another server of its name while it is `silent`.

    To destroy a server under a spinning executor ends that executor, and what it had to answer. One that is only told
    to refuse would answer beside the other one, and a client believes whichever is quicker.
    """

    silent = False

    async def execute(self, taken_data: Any) -> None:
        """Answer what came; nothing of a client's while silent."""
        if self.silent:
            taken_data = {key: value for key, value in taken_data.items() if key == "expired"}
        await super().execute(taken_data)

    def _send_result_response(self, *args: Any) -> None:
        if not self.silent:
            super()._send_result_response(*args)


class MillDoorActionServer(QuietActionServer):
    """The action mill_door: every goal is taken, and told what hinders it.

    Args:
        node: That serves it.
        execute: Mills the door of a goal.
        cancel: Whether a goal may be ended.
        group: Of its callbacks.
    """

    def __init__(
        self,
        node: Node,
        execute: Callable[[Any], MillDoor.Result],
        cancel: Callable[[Any], CancelResponse],
        group: CallbackGroup,
    ) -> None:
        super().__init__(
            node,
            MillDoor,
            "mill_door",
            execute,
            callback_group=group,
            goal_callback=lambda _: GoalResponse.ACCEPT,
            cancel_callback=cancel,
        )

    def end(self, goal: Any, end: RunEnd) -> MillDoor.Result:
        """Close a goal as its run ended; returns what the client is told."""
        try:
            if end.success:
                goal.succeed()
            elif goal.is_cancel_requested:
                goal.canceled()
            else:
                goal.abort()
        except rclpy_implementation.RCLError:
            # A process that is being stopped tells nobody any more; anything else is a fault.
            if self._node.context.ok():
                raise
        return run_end_into(end, MillDoor.Result)
