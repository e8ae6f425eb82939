"""Serialized texts and offered qualities of service for bags that are written without ROS."""

from __future__ import annotations

import random
import string
import struct
from typing import Any

SIZE = 1000  # characters of a text that does not compress


def text(content: str) -> bytes:
    """std_msgs/String in CDR, little endian."""
    data = content.encode() + b"\0"
    return b"\0\x01\0\0" + struct.pack("<I", len(data)) + data


def noise(seed: int) -> str:
    """A text that does not compress well."""
    return "".join(random.Random(seed).choices(string.ascii_letters, k=SIZE))


def offered(durability: str = "transient_local", depth: int = 7) -> list[dict[str, Any]]:
    """What one publisher offers, as rosbag2 writes it down."""
    forever = {"sec": 9223372036, "nsec": 854775807}
    return [
        {
            "history": "keep_last",
            "depth": depth,
            "reliability": "reliable",
            "durability": durability,
            "deadline": dict(forever),
            "lifespan": dict(forever),
            "liveliness": "automatic",
            "liveliness_lease_duration": dict(forever),
            "avoid_ros_namespace_conventions": False,
        }
    ]
