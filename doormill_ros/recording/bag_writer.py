"""Write a rosbag2 folder with MCAP storage, so that little is lost when the power goes."""

from __future__ import annotations

import functools
import json
import os
import secrets
import time
from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import suppress
from io import BufferedWriter
from pathlib import Path
from typing import Any

from mcap.writer import CompressionType, Writer

from doormill_ros.recording.errors import BagExistsError
from doormill_ros.recording.mcap_scan import scan
from doormill_ros.recording.metadata import BagRecord, FileRecord, TopicRecord
from doormill_ros.recording.repeats import RECORD, LatchedMemory, repeats_record
from doormill_ros.recording.schema import Schema, load_schema
from doormill_ros.yaml_text import text_of

CHUNK_SIZE = 1 << 20  # bytes
FLUSH_PERIOD = 0.25  # s; what a kill can cost at most
REPEATED_SHARE = 0.25  #: of `split_size`, for latched messages at the start of a further file
#: Metadata record by which Foxglove's platform knows the device and takes no recording twice.
FOXGLOVE = "foxglove"


class BagWriter:
    """An open bag. Not thread-safe: one thread writes.

    Args:
        folder: Made by the writer; must not exist or be empty.
        split_size: A new file is begun once one has this many bytes; 0 for never.
        ros_distro: Goes into metadata.yaml.
        device: What records, under Foxglove's name for it; empty: left out.
        custom: Goes there too, as custom data.
        clock: Monotonic [s].

    Raises:
        BagExistsError: The folder holds files.
    """

    def __init__(
        self,
        folder: Path,
        split_size: int = 0,
        ros_distro: str = "",
        device: str = "",
        custom: Mapping[str, str] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.folder = Path(folder)
        if self.folder.exists() and any(self.folder.iterdir()):
            raise BagExistsError(
                f"bag folder {self.folder} is not empty; choose another or remove it", folder=str(self.folder)
            )
        self.folder.mkdir(parents=True, exist_ok=True)
        self.record = BagRecord(ros_distro or os.environ.get("ROS_DISTRO", ""), custom=dict(custom or {}))
        self.split_size = split_size
        self._device = device
        self._latched = LatchedMemory()
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, Schema] = {}
        self._stream: BufferedWriter
        self._writer: Writer
        self._clock = clock
        self._flushed = clock()
        self._abandoned = False
        self._open_file()

    def add_topic(
        self,
        name: str,
        type_name: str,
        qos_profiles: list[dict[str, Any]] | None = None,
        schema: Schema | None = None,
    ) -> None:
        """Make a topic known; messages of unknown topics cannot be written. Repeating is harmless.

        Args:
            name: Full topic name.
            type_name: Full type name.
            qos_profiles: What the publishers offer, as rosbag2 writes it down.
            schema: Definition of the type; None for the installed one.

        Raises:
            UnknownTypeError: The type's definition is not installed.
        """
        if name in self.record.topics:
            return
        schema = schema or load_schema(type_name)
        schema = self._schemas.setdefault(schema.name, schema)
        self.record.topics[name] = TopicRecord(name, schema.name, schema.type_hash, qos_profiles or [])
        self._latched.know(name, qos_profiles or [])
        self._register(self.record.topics[name])
        self._untold = True

    def write(self, topic: str, data: bytes, log_time_ns: int, publish_time_ns: int | None = None) -> None:
        """Append a serialized (CDR) message of a known topic."""
        self._tell()
        published_ns = publish_time_ns or log_time_ns
        self._append(topic, data, log_time_ns, published_ns)
        self._latched.take(topic, data, published_ns)
        if self.split_size and self._stream.tell() >= self.split_size:
            self._close_file()
            self._open_file()
            self._repeat_latched()

    def _append(self, topic: str, data: bytes, log_time_ns: int, published_ns: int) -> None:
        self._writer.add_message(self._channels[topic], log_time_ns, data, published_ns)
        self.record.topics[topic].message_count += 1
        self._in_file[topic] += 1
        self.record.files[-1].count(log_time_ns)

    def _repeat_latched(self) -> None:
        """Begin a further file with what late joiners get, after all that was written."""
        messages = self._latched.chosen(REPEATED_SHARE * self.split_size)
        if not messages:
            return
        stamp_ns = 1 + max(file.end_ns for file in self.record.files if file.end_ns is not None)
        self._writer.add_metadata(RECORD, repeats_record(messages, stamp_ns))
        for message in messages:
            self._append(message.topic, message.data, stamp_ns, message.published_ns)
            self._repeated[message.topic] += 1

    def flush(self, force: bool = False, next_in: float = 0.0) -> None:
        """Hand the open chunk to the operating system once it is due.

        Args:
            force: It is due now.
            next_in: When this is called next [s]; due is what would be older than `FLUSH_PERIOD` by then.
        """
        self._tell()
        now = self._clock()
        if force or now + next_in - self._flushed >= FLUSH_PERIOD:
            self._writer.flush()
            self._flushed = now

    def close(self, dropped: Mapping[str, int] | None = None) -> None:
        """Finish the file and the metadata.

        Args:
            dropped: Messages that were lost, by topic; kept in the metadata's custom data.

        Raises:
            OSError: They cannot be written.
        """
        if dropped is not None:
            self.record.custom["dropped"] = str(sum(dropped.values()))
            self.record.custom |= {f"dropped {topic}": str(count) for topic, count in sorted(dropped.items())}
        if self._abandoned:
            self.record.write(self.folder)
        else:
            self._close_file()

    def abandon(self) -> dict[str, int]:
        """Give up the open file after an error of the disk; nothing can be written any more.

        Returns:
            Messages by topic that were taken and did not reach the file.
        """
        self._abandoned = True
        with suppress(OSError):
            self._stream.close()
        file = self.record.files[-1]
        found: Counter[str] = Counter()
        with suppress(OSError):
            found.update(item.channel.topic for item in scan(self.folder / file.name))
        lost: dict[str, int] = {}
        for topic, count in self._in_file.items():
            gone = count - found[topic]
            self.record.topics[topic].message_count -= gone
            file.message_count -= gone
            # What is repeated comes first in the file, and is in the one before.
            own = count - max(found[topic], self._repeated[topic])
            if own > 0:
                lost[topic] = own
        return lost

    def _open_file(self) -> None:
        name = f"{self.folder.name}_{len(self.record.files)}.mcap"
        self.record.files.append(FileRecord(name))
        self._in_file: Counter[str] = Counter()
        self._repeated: Counter[str] = Counter()
        self._stream = open(self.folder / name, "wb")  # noqa: SIM115  closed by _close_file
        self._writer = Writer(self._stream, chunk_size=CHUNK_SIZE, compression=CompressionType.ZSTD)
        self._writer.start(profile="ros2", library="doormill_ros")
        # Another key for each file: contents that differ must not have one key.
        device = {"deviceName": self._device} if self._device else {}
        self._writer.add_metadata(FOXGLOVE, {**device, "key": secrets.token_hex(16)})
        self._channels.clear()
        for topic in self.record.topics.values():
            self._register(topic)
        self._untold = True
        self._tell()

    def _tell(self) -> None:
        """Write metadata.yaml once for all topics that were made known, before the first message after them."""
        if self._untold:
            self.record.write(self.folder)
            self._untold = False

    def _close_file(self) -> None:
        document = text_of(self.record.document())
        self._writer.add_metadata("rosbag2", {"serialized_metadata": document})
        self._writer.finish()
        self._stream.close()
        self.record.write(self.folder)

    def _register(self, topic: TopicRecord) -> None:
        schema = self._schemas[topic.type]
        schema_id = self._writer.register_schema(schema.name, "ros2msg", schema.text.encode())
        self._channels[topic.name] = self._writer.register_channel(
            topic.name,
            "cdr",
            schema_id,
            {
                "offered_qos_profiles": _text_of_profiles(json.dumps(topic.qos_profiles)),
                "topic_type_hash": schema.type_hash,
            },
        )


@functools.lru_cache(maxsize=64)
def _text_of_profiles(profiles: str) -> str:
    """YAML of what is given as JSON: a cell's topics share a few profiles, and each takes a millisecond to put down."""
    return text_of(json.loads(profiles))
