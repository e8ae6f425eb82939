"""Topics that are found at run time: their message class, what to ask of their publishers, how to write that down."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from doormill_ros.recording.schema import FEEDBACK

INFINITE = {"sec": 9223372036, "nsec": 854775807}  #: as rosbag2 writes down that there is no limit


def type_name(message_type: Any) -> str:
    """Full name of a message class, for example "std_msgs/msg/Bool"."""
    package, kind, _ = message_type.__module__.split(".", 2)
    return f"{package}/{kind}/{message_type.__name__}"


def is_hidden(topic: str) -> bool:
    """True for what ROS' tools leave out by default: a part of the name begins with an underscore."""
    return any(part.startswith("_") for part in topic.split("/"))


def message_class(name: str) -> Any:
    """The class of a message type by its full name.

    Raises:
        ImportError, AttributeError: The type's package is not installed.
    """
    package, kind, message = name.split("/")
    module = import_module(f"{package}.{kind}")
    if feedback := FEEDBACK.fullmatch(name):
        return getattr(module, feedback[2]).Impl.FeedbackMessage
    return getattr(module, message)


def matching(offers: Sequence[QoSProfile]) -> QoSProfile:
    """The strictest request that every publisher satisfies."""
    reliable = all(o.reliability == ReliabilityPolicy.RELIABLE for o in offers)
    latched = all(o.durability == DurabilityPolicy.TRANSIENT_LOCAL for o in offers)
    return QoSProfile(
        depth=100,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def _time(duration: Duration) -> dict[str, int]:
    nanoseconds = duration.nanoseconds
    if nanoseconds <= 0 or nanoseconds >= 9223372036854775807:
        return dict(INFINITE)
    return {"sec": nanoseconds // 1_000_000_000, "nsec": nanoseconds % 1_000_000_000}


def qos_document(qos: QoSProfile) -> dict[str, Any]:
    """Quality of service as one entry of rosbag2's `offered_qos_profiles`, metadata version 9."""
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
