"""Read a bag message by message, without ROS and without loading it whole."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rosbags.rosbag2 import Reader

from doormill_ros.recording.errors import BagError, UnreadableBagError
from doormill_ros.recording.mcap_chunks import check_chunks
from doormill_ros.recording.mcap_index import definitions_in, messages_in, topics_in
from doormill_ros.recording.mcap_scan import ScannedMessage, is_complete, scan
from doormill_ros.recording.repeats import repeated_in
from doormill_ros.recording.typestores import known_types, register, typestore_of


@dataclass(frozen=True)
class BagMessage:
    """A message of a bag.

    Attributes:
        topic: Full topic name.
        stamp_ns: When it was recorded [ns since the epoch].
        message: The message with the fields of its type.
        data: The same, serialized (CDR).
        type_name: Full type name.
    """

    topic: str
    stamp_ns: int
    message: Any
    data: bytes
    type_name: str


def bag_files(folder: Path) -> list[Path]:
    """MCAP files of a bag in the order in which they were begun."""

    def number(path: Path) -> tuple[int, str]:
        match = re.search(r"_(\d+)$", path.stem)
        return (int(match[1]) if match else 0, path.name)

    return sorted(folder.glob("*.mcap"), key=number)


def is_broken_off(folder: Path) -> bool:
    """True for a bag whose recorder was killed: a file without end, or files without metadata.yaml."""
    files = bag_files(folder) if folder.is_dir() else [folder] if folder.suffix == ".mcap" else []
    try:
        unfinished = [path for path in files if not is_complete(path)]
    except OSError as error:
        raise _unreadable(folder, error) from error
    return bool(unfinished) or (folder.is_dir() and bool(files) and not (folder / "metadata.yaml").exists())


def topics_of(folder: Path) -> list[str]:
    """Full names of the topics of a bag.

    Raises:
        UnreadableBagError: No such bag, or damaged beyond reading.
    """
    if is_broken_off(folder):
        return list(dict.fromkeys(item.channel.topic for path in _files(folder) for item in scan(path)))
    try:
        if files := _files(folder):
            return list(dict.fromkeys(topic for path in files for topic in topics_in(path)))
        with Reader(folder) as reader:
            return [connection.topic for connection in reader.connections]
    except Exception as error:  # the library raises many kinds for a damaged file
        raise _unreadable(folder, error) from error


def read_bag(
    folder: Path, topics: Sequence[str] | Callable[[str], object] | None = None
) -> Iterator[BagMessage]:
    """Messages in the order in which they were recorded.

    A bag whose recorder was killed is read as far as it was written. What a further file repeats of earlier ones is
    left out, unless that file is read alone.

    Args:
        folder: Bag folder with metadata.yaml, or a file of one.
        topics: Full topic names to read, or what tells of one whether to; None for all.

    Raises:
        UnreadableBagError: No such bag, or damaged beyond reading.
    """
    wanted = topics if callable(topics) else lambda name: topics is None or name in topics
    messages = _scanned(folder, wanted) if is_broken_off(folder) else _indexed(folder, wanted)
    try:
        for path in _files(folder):
            check_chunks(path)
        yield from messages
    except UnreadableBagError:
        raise
    except Exception as error:  # the library raises many kinds for a damaged file
        raise _unreadable(folder, error) from error


def _indexed(folder: Path, wanted: Callable[[str], object]) -> Iterator[BagMessage]:
    files = _files(folder)
    if not files:
        yield from _stored_otherwise(folder, wanted)
    # One store for all of a bag: what two messages hold of the same type has to be of the same class.
    store = known_types(tuple(dict.fromkeys(d for path in files for d in definitions_in(path, wanted))))
    repeated = sum((repeated_in(path) for path in files[1:]), Counter())
    for path in files:
        for item in messages_in(path, wanted):
            topic, stamp_ns, data = item.channel.topic, item.message.log_time, item.message.data
            if repeated and _is_repeated(repeated, topic, stamp_ns):
                continue
            message = store.deserialize_cdr(data, item.schema.name)
            yield BagMessage(topic, stamp_ns, message, bytes(data), item.schema.name)


def _stored_otherwise(folder: Path, wanted: Callable[[str], object]) -> Iterator[BagMessage]:
    """Messages of a bag whose storage is not MCAP, or whose files are compressed as a whole."""
    with Reader(folder) as reader:
        chosen = [c for c in reader.connections if wanted(c.topic)]
        if not chosen:
            return
        store = known_types(tuple((c.msgtype, c.msgdef.data) for c in chosen))
        for connection, stamp_ns, data in reader.messages(connections=chosen):
            message = store.deserialize_cdr(data, connection.msgtype)
            yield BagMessage(connection.topic, stamp_ns, message, bytes(data), connection.msgtype)


def _scanned(folder: Path, wanted: Callable[[str], object]) -> Iterator[BagMessage]:
    store, known = typestore_of(()), set()
    for path in _files(folder):
        for item in scan(path) if path == _files(folder)[0] else scan_further(path):
            if not wanted(item.channel.topic):
                continue
            name = item.schema.name
            if name not in known:
                known.add(name)
                register(store, name, item.schema.data.decode("utf-8"))
            message = store.deserialize_cdr(item.message.data, name)
            yield BagMessage(
                item.channel.topic, item.message.log_time, message, bytes(item.message.data), name
            )


def scan_further(path: Path) -> Iterator[ScannedMessage]:
    """As `scan`, for a file that continues another one: without what it repeats."""
    repeated = repeated_in(path)
    for item in scan(path):
        if not _is_repeated(repeated, item.channel.topic, item.message.log_time):
            yield item


def _is_repeated(repeated: Counter[tuple[str, int]], topic: str, stamp_ns: int) -> bool:
    """Count down: repeated messages come before others of their stamp."""
    if repeated[topic, stamp_ns] <= 0:
        return False
    repeated[topic, stamp_ns] -= 1
    return True


def _files(folder: Path) -> list[Path]:
    return bag_files(folder) if folder.is_dir() else [folder]


def _unreadable(folder: Path, error: Exception) -> BagError:
    lacking = _lacking(folder)
    held = folder.is_file() or (folder.is_dir() and bag_files(folder))
    advice = "name a folder with metadata.yaml and .mcap files"
    if held and not lacking:
        advice = "take another copy of the bag"
    return UnreadableBagError(
        f"bag {folder} cannot be read: {lacking or error}; {advice}", folder=str(folder)
    )


def _lacking(folder: Path) -> str:
    """Why a place is no bag at all; empty for one that might be."""
    try:
        if not folder.exists():
            return "there is no such folder"
        if not folder.is_dir():
            return "" if folder.suffix == ".mcap" else "it is neither a folder nor a .mcap file"
        if not (folder / "metadata.yaml").exists() and not bag_files(folder):
            return "it holds neither metadata.yaml nor a .mcap file"
    except OSError:  # the error met before tells more
        pass
    return ""
