"""Classes for messages as they travel, made from their definitions: without ROS, and read in a third of its time."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache, lru_cache
from typing import Any

from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from doormill_ros.recording.schema import load_schema


def typestore_of(definitions: Iterable[tuple[str, str]]) -> Typestore:
    """Types by their definitions with those of all they use, given as pairs of type name and text."""
    store = get_typestore(Stores.EMPTY)
    for name, text in definitions:
        register(store, name, text)
    return store


@lru_cache(maxsize=32)
def known_types(definitions: tuple[tuple[str, str], ...]) -> Typestore:
    """As `typestore_of`, made once for all messages of one software; nobody adds to it."""
    return typestore_of(definitions)


def register(store: Typestore, name: str, text: str) -> None:
    """Add a type and those it uses, but for what is there already."""
    types = get_types_from_msg(text, name)
    store.register({name: fields for name, fields in types.items() if name not in store.fielddefs})


@cache
def reader_of(name: str) -> Callable[[bytes], Any]:
    """What makes messages with the fields of an installed type of their bytes (CDR).

    ROS makes an object of every nested message twice, first with its defaults; a door's targets hold thousands.

    Args:
        name: Full type name, for example "std_msgs/msg/Bool".

    Raises:
        UnknownTypeError: The type's package is not installed.
    """
    schema = load_schema(name)
    store = known_types(((schema.name, schema.text),))

    def read(data: bytes) -> Any:
        return store.deserialize_cdr(memoryview(data), schema.name)

    return read
