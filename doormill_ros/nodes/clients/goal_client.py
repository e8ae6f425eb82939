"""The client of the action that mills a door."""

from __future__ import annotations

import threading

from rclpy.action import ActionClient


class GoalClient(ActionClient):  # type: ignore[misc]  # rclpy has no types
    """May be made while its node is spun: rclpy shows a client to the executor before it has given it the lock."""

    _lock = threading.Lock()
