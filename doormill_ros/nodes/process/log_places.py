"""From where a node logs, told to `inspect` before it looks for that among all that is loaded."""

from __future__ import annotations

import inspect
import sys

_WHO_LOGS = ("doormill_ros", "rclpy")


def tell_places() -> None:
    """Make the files of all modules known that log, so that the first message of a process costs what the next does.

    rclpy asks `inspect` for the caller of each message, and that asks the file system for the place of every module
    of the process, over a thousand, once a file turns up that it does not know. Where `inspect` remembers none,
    nothing changes.
    """
    known = getattr(inspect, "modulesbyfile", {})
    for name, module in sys.modules.copy().items():
        place = getattr(module, "__file__", None) if name.partition(".")[0] in _WHO_LOGS else None
        if place:
            known.setdefault(place, name)
