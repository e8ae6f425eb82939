"""What can be wrong with force logs of milling."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class MillingError(DoormillError):
    """A force log that tells no process wrench."""

    code = 590


SegmentError = MillingError.row("SegmentError", 592, "A path segment holds too few samples of the force log.")
PayloadError = MillingError.row("PayloadError", 593, "The readings do not tell the spindle's weight.")
