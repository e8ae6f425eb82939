"""Messages that hold others by the thousand, read from the bytes that a subscription hands over."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from doormill_ros.nodes.base.found_topics import type_name
from doormill_ros.nodes.base.topics import Topic
from doormill_ros.recording.typestores import reader_of


def reading(topic: Topic, callback: Callable[[Any], None]) -> Callable[[Any], None]:
    """What a topic's subscription calls so that `callback` gets messages: of a nested topic it is given bytes."""
    if not topic.nested:
        return callback
    read = reader_of(type_name(topic.type))
    return lambda data: callback(read(data))
