"""The thread that takes what was received out of a queue and writes it into a bag."""

from __future__ import annotations

import threading
from collections import Counter
from typing import Any

from doormill_ros.recording.bag_writer import BagWriter
from doormill_ros.recording.bounded_queue import BoundedQueue
from doormill_ros.recording.errors import BagEndError

WRITE_PERIOD = 0.1  # s


class BagFiller:
    """Fills a bag until the queue is closed and empty, or the disk is full.

    Args:
        queue: What was received; counts what cannot be written as dropped.
        writer: The open bag; from now on nobody else writes to it.

    Attributes:
        failure: Why nothing is written any more and what to do; empty while all is well.
    """

    def __init__(self, queue: BoundedQueue, writer: BagWriter) -> None:
        self.failure = ""
        self._queue = queue
        self._writer = writer
        self._lock = threading.Lock()
        self._thread = threading.Thread(target=self._fill, name="bag_writer", daemon=True)

    def start(self) -> None:
        """Begin to write."""
        self._thread.start()

    def add_topic(self, name: str, type_name: str, qos_profiles: list[dict[str, Any]]) -> None:
        """Make a topic known; see `BagWriter.add_topic`.

        Raises:
            UnknownTypeError: The type's definition is not installed.
        """
        with self._lock:
            self._writer.add_topic(name, type_name, qos_profiles)

    def stop(self) -> None:
        """Write what still waits and close the bag.

        Raises:
            BagEndError: Its last file or its metadata cannot be written.
        """
        self._queue.close()
        self._thread.join()
        with self._lock:
            try:
                self._writer.close(self._queue.dropped)
            except OSError as error:
                raise BagEndError(
                    f"the end of bag {self._writer.folder} cannot be written: {error}; free the disk; what was written "
                    "before can be read"
                ) from error

    def _fill(self) -> None:
        while not self._queue.closed:
            received = self._queue.take(WRITE_PERIOD)
            written = 0
            try:
                with self._lock:
                    for item in received:
                        self._writer.write(item.topic, item.data, item.received_ns, item.published_ns)
                        written += 1
                    self._writer.flush(next_in=WRITE_PERIOD)
            except OSError as error:
                self._queue.close(failed=True)
                with self._lock:
                    lost = Counter(self._writer.abandon())
                # What came since they were taken was let in still, and nobody else will take it.
                lost.update(item.topic for item in (*received[written:], *self._queue.take(0.0)))
                self._queue.count_dropped(lost)
                self.failure = f"the bag cannot be written: {error}; free the disk and restart the recorder"
