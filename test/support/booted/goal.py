"""Have a door milled by the cell of this machine: `python goal.py DOOR_ID`; prints the result as JSON."""

from __future__ import annotations

import json
import sys

import rclpy
from rclpy.node import Node

from doormill_interfaces.action import MillDoor
from doormill_ros.nodes.goal_client import GoalClient

FOUND = 30.0  # s
MILLED = 240.0  # s


def main(door_id: str) -> None:
    """Send the goal and wait for its result.

    Raises:
        TimeoutError: There is none in time.
    """
    rclpy.init()
    node = Node("customer")
    goals = GoalClient(node, MillDoor, "mill_door")
    if not goals.wait_for_server(FOUND):
        raise TimeoutError(f"nobody takes goals within {FOUND:g} s")
    sent = goals.send_goal_async(MillDoor.Goal(door_id=door_id))
    rclpy.spin_until_future_complete(node, sent, timeout_sec=FOUND)
    handle = sent.result()
    if handle is None or not handle.accepted:
        raise TimeoutError("the goal was not accepted")
    ended = handle.get_result_async()
    rclpy.spin_until_future_complete(node, ended, timeout_sec=MILLED)
    if ended.result() is None:
        raise TimeoutError(f"no result within {MILLED:g} s")
    result = ended.result().result
    shown = ("success", "error_code", "message", "measured")
    sys.stdout.write(json.dumps({name: getattr(result, name) for name in shown}) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
