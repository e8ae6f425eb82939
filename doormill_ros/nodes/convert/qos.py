"""Quality of service as rosbag2 writes it down."""

from __future__ import annotations

from typing import Any

from rclpy.duration import Duration
from rclpy.qos import QoSProfile

INFINITE = {"sec": 9223372036, "nsec": 854775807}


def _time(duration: Duration) -> dict[str, int]:
    nanoseconds = duration.nanoseconds
    if nanoseconds <= 0 or nanoseconds >= 9223372036854775807:
        return dict(INFINITE)
    return {"sec": nanoseconds // 1_000_000_000, "nsec": nanoseconds % 1_000_000_000}


def qos_document(qos: QoSProfile) -> dict[str, Any]:
    """One entry of `offered_qos_profiles`, metadata version 9."""
    return {
        "history": qos.history.short_key,
        "depth": qos.depth,
        "reliability": qos.reliability.short_key,
        "durability": qos.durability.short_key,
        "deadline": _time(qos.deadline),
        "lifespan": _time(qos.lifespan),
        "liveliness": qos.liveliness.short_key,
        "liveliness_lease_duration": _time(qos.liveliness_lease_duration),
        "avoid_ros_namespace_conventions": qos.avoid_ros_namespace_conventions,
    }
