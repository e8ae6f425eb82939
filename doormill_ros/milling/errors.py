"""What can be wrong with cutting parameters and force logs.

DoormillError
`-- 590..599  MillingError
    |-- 591 CuttingParameterError   a speed, feed, diameter or flute count that cannot be
    |-- 592 SegmentError            a path segment that the force log does not cover
    `-- 593 PayloadError            a spindle weight that the readings cannot tell
"""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class MillingError(DoormillError):
    """Any error of the milling package."""

    code = 590


class CuttingParameterError(MillingError):
    """A cutting parameter is not a positive, finite number."""

    code = 591


class SegmentError(MillingError):
    """A path segment holds too few samples of the force log."""

    code = 592


class PayloadError(MillingError):
    """The spindle weight cannot be told from the given readings."""

    code = 593
