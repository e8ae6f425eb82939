"""Which part of its sensor a camera sends, and how coarsely: roi and binning of a sensor_msgs/CameraInfo.

K and the size in a camera info are those of the whole sensor (REP 104), whatever part of it is in the picture.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.errors import BadCameraInfo
from doormill_ros.localization.lens import SMALLEST

_MOST_BINNED = 16  # px of the sensor along a side of one of the picture


def in_window(k: FloatArray, message: Any) -> tuple[FloatArray, tuple[int, int]]:
    """Camera matrix (3, 3) and size [px] of the pictures themselves; distortion acts before both and stays.

    A pixel's centre has whole coordinates. One that stands for n of the sensor's lies in the middle of these:
    u = n u' + (n - 1) / 2 + offset.

    Args:
        k: Camera matrix of the whole sensor [px], shape (3, 3).
        message: The sensor_msgs/CameraInfo; one without these fields sends the whole sensor.

    Raises:
        BadCameraInfo: The region is not on the sensor, or nothing is left of it.
    """
    size = (int(message.width), int(message.height))
    corner, sent = _region(getattr(message, "roi", None), size)
    bins = [max(1, int(getattr(message, name, 0))) for name in ("binning_x", "binning_y")]
    out = (sent[0] // bins[0], sent[1] // bins[1])
    if max(bins) > _MOST_BINNED or min(out) < SMALLEST:
        raise BadCameraInfo(
            f"the camera info has binning of {bins[0]} x {bins[1]} px, which leaves {out[0]} x {out[1]} px, "
            f"allowed are binning of up to {_MOST_BINNED} px and pictures of {SMALLEST} px and more; "
            "check the camera's driver",
            binning=tuple(bins),
        )
    coarse = np.diag([1.0 / bins[0], 1.0 / bins[1], 1.0])
    coarse[:2, 2] = [(1 - n) / 2 / n - c / n for n, c in zip(bins, corner, strict=True)]
    return coarse @ k, out


def _region(roi: Any, size: tuple[int, int]) -> tuple[tuple[int, int], tuple[int, int]]:
    """First column and row, and columns and rows, of the sensor's pixels that are sent."""
    if roi is None:
        return (0, 0), size
    corner, sent = (int(roi.x_offset), int(roi.y_offset)), (int(roi.width), int(roi.height))
    if corner == (0, 0) and sent == (0, 0):
        return corner, size
    if not all(s >= 1 and c + s <= whole for c, s, whole in zip(corner, sent, size, strict=True)):
        raise BadCameraInfo(
            f"the camera info has a region of interest of {sent[0]} x {sent[1]} px at ({corner[0]}, {corner[1]}), "
            f"allowed is one inside the {size[0]} x {size[1]} px that it is for; check the camera's driver",
            roi=(*corner, *sent),
        )
    return corner, sent
