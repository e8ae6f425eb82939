"""Latched messages again at the start of each further file of a bag, so that each file can be looked at alone."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mcap.records import Chunk, Message, Metadata
from mcap.stream_reader import StreamReader

#: MCAP metadata record before them: their stamp, and how many there are of each topic.
RECORD, STAMP = "doormill_repeated", "stamp"
#: Every node latches its own static frames on one topic.
STATIC_FRAMES, STATIC_NODES = "tf_static", 10


@dataclass(frozen=True)
class LatchedMessage:
    """A serialized message of a latched topic; when it was sent [ns since the epoch]."""

    topic: str
    data: bytes
    published_ns: int


class LatchedMemory:
    """The messages that a late joiner would get."""

    def __init__(self) -> None:
        self._latest: dict[str, deque[LatchedMessage]] = {}

    def know(self, topic: str, qos_profiles: list[dict[str, Any]]) -> None:
        """A topic, and what its publishers offer as rosbag2 writes it down."""
        depths = [p.get("depth", 1) for p in qos_profiles if p.get("durability") == "transient_local"]
        if depths:
            least = STATIC_NODES if topic.rpartition("/")[2] == STATIC_FRAMES else 1
            self._latest[topic] = deque(maxlen=max(least, *depths))

    def take(self, topic: str, data: bytes, published_ns: int) -> None:
        """A message was written."""
        if topic in self._latest:
            self._latest[topic].append(LatchedMessage(topic, data, published_ns))

    def chosen(self, room: float) -> list[LatchedMessage]:
        """What is repeated: all, or the topics with the smallest messages that fit into so many bytes."""
        sizes = sorted(
            (sum(len(m.data) for m in kept), topic) for topic, kept in self._latest.items() if kept
        )
        chosen: list[LatchedMessage] = []
        for size, topic in sizes:
            room -= size
            if room < 0:
                break
            chosen.extend(self._latest[topic])
        return chosen


def repeats_record(messages: Iterable[LatchedMessage], stamp_ns: int) -> dict[str, str]:
    """Content of the metadata record before repeated messages."""
    counts = Counter(message.topic for message in messages)
    return {STAMP: str(stamp_ns), **{topic: str(count) for topic, count in counts.items()}}


def repeated_in(path: Path) -> Counter[tuple[str, int]]:
    """How many messages of a file repeat earlier ones, by topic and stamp [ns since the epoch]."""
    try:
        with path.open("rb") as stream:
            for record in StreamReader(stream, emit_chunks=True).records:
                if isinstance(record, Metadata) and record.name == RECORD:
                    document = dict(record.metadata)
                    stamp = int(document.pop(STAMP))
                    return Counter({(topic, stamp): int(count) for topic, count in document.items()})
                if isinstance(record, Chunk | Message):
                    break
    except Exception:  # the library raises many kinds; whoever reads the messages tells of the damage
        pass
    return Counter()
