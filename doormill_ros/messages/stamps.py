"""Stamps of messages as numbers, wherever the messages come from."""

from __future__ import annotations

from typing import Any

from doormill_ros.units import ns_to_s


def nanoseconds_of(stamp: Any) -> int:
    """Nanoseconds since the epoch of a builtin_interfaces/Time."""
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def seconds_of(stamp: Any) -> float:
    """Seconds since the epoch of a builtin_interfaces/Time."""
    return float(stamp.sec + ns_to_s(stamp.nanosec))
