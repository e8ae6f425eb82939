"""Have a door milled by the cell of this machine: `python goal.py DOOR_ID`; prints the result as JSON."""

from __future__ import annotations

import json
import sys
import time

import rclpy
from rclpy.node import Node

from doormill_interfaces.action import MillDoor
from doormill_ros.nodes.clients.goal_client import GoalClient

FOUND = 30.0  # s
#: A server drops its answer to a client that it has not heard of, which a client cannot see.
HEARD = 3.0  # s
MILLED = 240.0  # s


def main(door_id: str) -> None:
    """Send the goal and wait for its result.

    Raises:
        TimeoutError: There is none in time.
        ValueError: The server takes no goals.
    """
    rclpy.init()
    node = Node("customer")
    goals = GoalClient(node, MillDoor, "mill_door")
    if not goals.wait_for_server(FOUND):
        raise TimeoutError(f"nobody takes goals within {FOUND:g} s")
    time.sleep(HEARD)
    sent = goals.send_goal_async(MillDoor.Goal(door_id=door_id))
    rclpy.spin_until_future_complete(node, sent, timeout_sec=FOUND)
    handle = sent.result()
    if handle is None:
        raise TimeoutError(f"nobody answered the goal within {FOUND:g} s")
    if not handle.accepted:
        raise ValueError("the goal was refused before it was looked at")
    ended = handle.get_result_async()
    rclpy.spin_until_future_complete(node, ended, timeout_sec=MILLED)
    if ended.result() is None:
        raise TimeoutError(f"no result within {MILLED:g} s")
    result = ended.result().result
    shown = ("success", "error_code", "message", "measured")
    sys.stdout.write(json.dumps({name: getattr(result, name) for name in shown}) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
