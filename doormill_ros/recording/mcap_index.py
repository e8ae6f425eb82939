"""Read an MCAP file that was closed by its index: only what is asked for is unpacked."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from mcap.reader import SeekingReader
from mcap.summary import Summary

from doormill_ros.recording.mcap_scan import LARGEST_RECORD, ScannedMessage, is_complete, scan


def topics_in(path: Path) -> list[str]:
    """Full names of the topics of a file, in the order of their channels."""
    summary = _summary_of(path)
    if summary is None:
        return list(dict.fromkeys(item.channel.topic for item in scan(path)))
    return list(dict.fromkeys(channel.topic for _, channel in sorted(summary.channels.items())))


def definitions_in(path: Path, wanted: Callable[[str], object]) -> list[tuple[str, str]]:
    """Name and text of each type of a file's topics that are wanted, in the order of their channels."""
    summary = _summary_of(path)
    if summary is None:
        schemas = [item.schema for item in scan(path) if wanted(item.channel.topic)]
    else:
        channels = [channel for _, channel in sorted(summary.channels.items()) if wanted(channel.topic)]
        schemas = [summary.schemas[c.schema_id] for c in channels if c.schema_id in summary.schemas]
    return list(dict.fromkeys((schema.name, schema.data.decode("utf-8")) for schema in schemas))


def messages_in(path: Path, wanted: Callable[[str], object]) -> Iterator[ScannedMessage]:
    """Messages of topics that are wanted in the order in which they were recorded; without an index as `scan`."""
    with path.open("rb") as stream:
        reader = SeekingReader(stream, record_size_limit=LARGEST_RECORD)
        summary = reader.get_summary()
        if summary is None:
            yield from (item for item in scan(path) if wanted(item.channel.topic))
            return
        topics = [channel.topic for channel in summary.channels.values() if wanted(channel.topic)]
        if not topics:
            return
        for schema, channel, message in reader.iter_messages(topics=topics):
            if schema is not None:
                yield ScannedMessage(schema, channel, message)


def messages_held(path: Path) -> int:
    """How many messages a file holds: by its index, or where it has none by reading as far as it goes."""
    summary = _summary_of(path) if is_complete(path) else None
    if summary is None or summary.statistics is None:
        return sum(1 for _ in scan(path))
    return int(summary.statistics.message_count)


def _summary_of(path: Path) -> Summary | None:
    with path.open("rb") as stream:
        return SeekingReader(stream, record_size_limit=LARGEST_RECORD).get_summary()
