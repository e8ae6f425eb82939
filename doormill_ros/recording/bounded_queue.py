"""A queue between the threads that receive messages and the one that writes them."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Received:
    """A serialized message as it arrived; times in nanoseconds since the epoch."""

    topic: str
    data: bytes
    received_ns: int
    published_ns: int


class BoundedQueue:
    """Holds at most `limit` bytes; what does not fit is counted, by topic, never silently lost."""

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.dropped: dict[str, int] = {}
        self._items: deque[Received] = deque()
        self._size = 0
        self._closed = False
        self._failed = False
        self._changed = threading.Condition()

    def put(self, item: Received) -> bool:
        """Append; False when the message was dropped, or came after the end of the recording."""
        with self._changed:
            if self._closed and not self._failed:
                return False
            if self._failed or self._size + len(item.data) > self.limit:
                self.dropped[item.topic] = self.dropped.get(item.topic, 0) + 1
                return False
            self._items.append(item)
            self._size += len(item.data)
            self._changed.notify()
            return True

    def take(self, timeout: float) -> list[Received]:
        """Everything that waits, oldest first; empty after `timeout` seconds without anything."""
        with self._changed:
            if not self._items and not self._closed:
                self._changed.wait(timeout)
            items = list(self._items)
            self._items.clear()
            self._size = 0
            return items

    def count_dropped(self, lost: Mapping[str, int]) -> None:
        """Count messages, by topic, that were taken and could not be written."""
        with self._changed:
            for topic, count in lost.items():
                self.dropped[topic] = self.dropped.get(topic, 0) + count

    def close(self, failed: bool = False) -> None:
        """Refuse further messages and wake the writer.

        Args:
            failed: The writer gave up: what comes from now on counts as dropped.
        """
        with self._changed:
            self._closed = True
            self._failed = self._failed or failed
            self._changed.notify()

    @property
    def closed(self) -> bool:
        """True once closed and empty."""
        with self._changed:
            return self._closed and not self._items
