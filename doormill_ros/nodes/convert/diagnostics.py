"""The health of a node as a message of /diagnostics."""

from __future__ import annotations

from collections.abc import Mapping

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from std_msgs.msg import Header


def diagnostics(
    name: str, level: bytes, message: str, values: Mapping[str, object], stamp: Time
) -> DiagnosticArray:
    """One status.

    Args:
        name: Of who tells it, with its namespace.
        level: Of `DiagnosticStatus`.
        message: In one sentence.
        values: What else is told, by its key.
        stamp: When.
    """
    status = DiagnosticStatus(
        level=level,
        name=name.lstrip("/"),
        message=message,
        hardware_id="doormill",
        values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
    )
    return DiagnosticArray(header=Header(stamp=stamp), status=[status])
