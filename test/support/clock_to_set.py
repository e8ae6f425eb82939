"""A clock that a test sets: sends /clock."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from builtin_interfaces.msg import Time
from rosgraph_msgs.msg import Clock

PERIOD = 0.02  # s between two messages


class ClockToSet:
    """What the machine's clock says, and `shift` more.

    Args:
        node: Sends it.
        period: Between two messages [s].
    """

    def __init__(self, node: Any, period: float = PERIOD) -> None:
        self._publisher = node.create_publisher(Clock, "/clock", 1)
        self._period = period
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self.shift = 0.0

    def _run(self) -> None:
        while not self._ended.wait(self._period):
            now = time.time() + self.shift
            seconds = int(now)
            self._publisher.publish(Clock(clock=Time(sec=seconds, nanosec=int((now - seconds) * 1e9))))

    @contextmanager
    def running(self) -> Iterator[ClockToSet]:
        """Send until the end of the block."""
        self._thread.start()
        try:
            yield self
        finally:
            self._ended.set()
            self._thread.join()
