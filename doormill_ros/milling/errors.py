"""What can be wrong with cutting parameters and force logs."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class MillingError(DoormillError):
    """Any error of the milling package."""

    code = 590


CuttingParameterError = MillingError.row(
    "CuttingParameterError", 591, "A parameter is no positive, finite number."
)
SegmentError = MillingError.row("SegmentError", 592, "A path segment holds too few samples of the force log.")
PayloadError = MillingError.row("PayloadError", 593, "The readings do not tell the spindle's weight.")
