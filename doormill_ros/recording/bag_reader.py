"""Read a bag message by message, without ROS and without loading it whole."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection
from rosbags.rosbag2 import Reader, ReaderError
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from doormill_ros.recording.errors import UnreadableBagError


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


def typestore_of(connections: Sequence[Connection]) -> Typestore:
    """Types by the definitions that travel in the bag."""
    store = get_typestore(Stores.EMPTY)
    for connection in connections:
        types = get_types_from_msg(connection.msgdef.data, connection.msgtype)
        store.register({name: fields for name, fields in types.items() if name not in store.fielddefs})
    return store


def topics_of(folder: Path) -> list[str]:
    """Full names of the topics of a bag.

    Raises:
        UnreadableBagError: No such bag, or damaged beyond reading.
    """
    try:
        with Reader(folder) as reader:
            return [connection.topic for connection in reader.connections]
    except (ReaderError, OSError) as error:
        raise _unreadable(folder, error) from error


def _unreadable(folder: Path, error: Exception) -> UnreadableBagError:
    return UnreadableBagError(
        f"bag {folder} cannot be read: {error}; name a folder with metadata.yaml and .mcap files",
        folder=str(folder),
    )


def read_bag(folder: Path, topics: Sequence[str] | None = None) -> Iterator[BagMessage]:
    """Messages in the order in which they were recorded.

    Args:
        folder: Bag folder with metadata.yaml.
        topics: Full topic names to read; None for all.

    Raises:
        UnreadableBagError: No such bag, or damaged beyond reading.
    """
    try:
        with Reader(folder) as reader:
            store = typestore_of(reader.connections)
            chosen = [c for c in reader.connections if topics is None or c.topic in topics]
            if not chosen:
                return
            for connection, stamp_ns, data in reader.messages(connections=chosen):
                message = store.deserialize_cdr(data, connection.msgtype)
                yield BagMessage(connection.topic, stamp_ns, message, bytes(data), connection.msgtype)
    except (ReaderError, OSError) as error:
        raise _unreadable(folder, error) from error
