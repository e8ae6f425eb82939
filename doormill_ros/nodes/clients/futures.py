"""Wait for a future from outside the executor that completes it."""

from __future__ import annotations

import threading
from typing import Any

from doormill_ros.cell.run.waiting import wait_until


def result_of(future: Any, limit: float, otherwise: str) -> Any:
    """Result of an rclpy future.

    Args:
        future: Of a request or a goal.
        limit: Longest wait [s].
        otherwise: What went missing, for the error.

    Raises:
        StageTimeoutError: It was not completed within the limit.
    """
    changed = threading.Condition()

    def completed(_: Any) -> None:
        with changed:
            changed.notify_all()

    future.add_done_callback(completed)
    wait_until(changed, future.done, limit, otherwise)
    return future.result()
