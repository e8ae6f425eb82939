"""The thread that writes a bag when the disk is full in the moment in which a message comes."""

from __future__ import annotations

import errno
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from doormill_ros.recording.bag_filler import BagFiller
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.bag_writer import FLUSH_PERIOD, BagWriter
from doormill_ros.recording.bounded_queue import BoundedQueue, Received
from doormill_ros.recording.errors import BagEndError
from support.bag_content import text
from support.waiting import until

TOPIC, MESSAGE = "run/note", bytes(8)


def received(stamp: int) -> Received:
    return Received(TOPIC, MESSAGE, stamp, stamp)


class FullDisk(BagWriter):
    """Has no room left, and while it finds out another message arrives."""

    queue: BoundedQueue

    def flush(self, force: bool = False, next_in: float = 0.0) -> None:
        assert self.queue.put(received(2))
        raise OSError(errno.ENOSPC, "No space left on device")


def test_topics_are_in_the_metadata_before_a_message_of_theirs_is_written(tmp_path: Path) -> None:
    """Once for all of them, and of one that is found later once more; with no message at all, soon."""
    writer = BagWriter(tmp_path / "bag")
    metadata = tmp_path / "bag" / "metadata.yaml"
    empty = metadata.stat().st_mtime_ns
    for name in ("run/note", "run/other"):
        writer.add_topic(name, "std_msgs/msg/String")
    assert metadata.stat().st_mtime_ns == empty
    writer.write(TOPIC, MESSAGE, 1)
    assert "run/note" in metadata.read_text()
    assert "run/other" in metadata.read_text()
    queue = BoundedQueue(1 << 20)
    filler = BagFiller(queue, writer)
    filler.start()
    filler.add_topic("run/late", "std_msgs/msg/String", [])
    until(lambda: "run/late" in metadata.read_text())
    filler.stop()


class Ticking(BoundedQueue):
    """Waits for as long as it may, on a clock of its own, while a message comes as each wait begins."""

    def __init__(self, folder: Path) -> None:
        super().__init__(1 << 20)
        self.now = 0.0
        self.rows: list[int] = []
        self._folder = folder

    def take(self, timeout: float) -> list[Received]:
        stamp = round(1e9 * self.now)
        self.now += timeout
        old = [s for s in self.rows if s < 1e9 * (self.now - FLUSH_PERIOD) - 1.0]
        found = {message.stamp_ns for message in read_bag(self._folder)}
        assert found.issuperset(old)
        if len(self.rows) == 20:
            self.close()
            return []
        self.rows.append(stamp)
        return [Received(TOPIC, text("x"), stamp, stamp)]


def test_what_was_received_is_in_the_file_within_a_quarter_of_a_second(tmp_path: Path) -> None:
    queue = Ticking(tmp_path / "bag")
    filler = BagFiller(queue, BagWriter(tmp_path / "bag", clock=lambda: queue.now))
    filler.add_topic(TOPIC, "std_msgs/msg/String", [])
    filler._fill()
    assert len(queue.rows) == 20
    assert queue.now > 4 * FLUSH_PERIOD


@pytest.fixture
def raised(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What ended a thread."""
    ended: list[Any] = []
    monkeypatch.setattr(threading, "excepthook", ended.append)
    return ended


def test_what_comes_while_the_disk_is_found_full_counts_as_lost(tmp_path: Path, raised: list[Any]) -> None:
    queue = BoundedQueue(1 << 20)
    writer = FullDisk(tmp_path / "bag", split_size=1 << 20)
    writer.queue = queue
    filler = BagFiller(queue, writer)
    filler.add_topic(TOPIC, "std_msgs/msg/String", [])
    queue.put(received(1))
    filler.start()
    filler._thread.join()
    assert not raised
    assert "No space left on device" in filler.failure
    assert queue.dropped == {TOPIC: 2}
    assert not queue.put(received(3))
    assert queue.dropped == {TOPIC: 3}
    filler.stop()


class NoEnd(BagWriter):
    """Finds no room for its last words."""

    def close(self, dropped: Mapping[str, int] | None = None) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")


def test_a_bag_that_cannot_be_ended_is_told_in_a_sentence(tmp_path: Path) -> None:
    filler = BagFiller(BoundedQueue(1 << 20), NoEnd(tmp_path / "bag"))
    filler.start()
    with pytest.raises(BagEndError) as told:
        filler.stop()
    assert str(tmp_path / "bag") in told.value.message
    assert "No space left on device; free the disk" in told.value.message
