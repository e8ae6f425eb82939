"""Read an MCAP file from its beginning as far as it goes: a recorder that was killed left no index."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader

MAGIC = b"\x89MCAP0\r\n"
#: More than the largest message of the cell; a damaged length must not ask for all memory.
LARGEST_RECORD = 1 << 28  # bytes


@dataclass(frozen=True)
class ScannedMessage:
    """A message with the channel and the schema that were in force."""

    schema: Schema
    channel: Channel
    message: Message


def is_complete(path: Path) -> bool:
    """True for a file that was closed: it ends with the format's magic bytes."""
    with path.open("rb") as stream:
        if stream.seek(0, 2) < 2 * len(MAGIC):
            return False
        stream.seek(-len(MAGIC), 2)
        return stream.read() == MAGIC


def scan(path: Path) -> Iterator[ScannedMessage]:
    """Messages in the order of the file, up to where it ends or is damaged."""
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    with path.open("rb") as stream:
        records = iter(StreamReader(stream, record_size_limit=LARGEST_RECORD).records)
        while True:
            try:
                record = next(records)
            except Exception:  # the library raises many kinds; each means that nothing more can be read
                return
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message):
                channel = channels.get(record.channel_id)
                if channel is not None and channel.schema_id in schemas:
                    yield ScannedMessage(schemas[channel.schema_id], channel, record)
