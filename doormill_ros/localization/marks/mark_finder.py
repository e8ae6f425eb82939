"""Finds the cell's marks in a picture to a few hundredths of a pixel."""

from __future__ import annotations

from math import ceil, floor, isfinite

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray, IntArray

SEARCH = 1.5  # radii of a dot by which it may be off
_AREA = (0.6, 1.6)  # of the dot expected
_SLIM = 0.7  # least ratio of its height and width
_FULL = 0.65  # least share of its bounding box; a circle has 0.785
_RIM = 0.5  # radii around a dot that belong to its black ring whatever the blur
_CONTRAST = 12.0  # least step from ring to dot [grey levels]


def find_marks(picture: ByteArray, expected: FloatArray, radii: FloatArray) -> FloatArray:
    """Centres of white dots on black rings.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        expected: Where they should be, u, v [px], shape (n, 2).
        radii: Of the dots [px], shape (n,).

    Returns:
        u, v [px], shape (n, 2); nan for a dot that is not seen.
    """
    found = [_find(picture, at, float(radius)) for at, radius in zip(expected, radii, strict=True)]
    return np.array(found, dtype=float).reshape(-1, 2)


def _find(picture: ByteArray, at: FloatArray, radius: float) -> FloatArray:
    lost = np.full(2, np.nan)
    u, v = at.tolist()
    if not (isfinite(u) and isfinite(v) and 2.0 <= radius < 0.1 * min(picture.shape)):
        return lost
    reach = (2.0 + SEARCH) * radius
    (left, right), (top, low) = (
        (max(ceil(middle - reach), 0), min(floor(middle + reach) + 1, side))
        for middle, side in zip((u, v), picture.shape[::-1], strict=True)
    )
    if min(right - left, low - top) < 3.0 * radius:
        return lost
    window = np.ascontiguousarray(picture[top:low, left:right])
    _, bright = cv2.threshold(window, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    _, _, boxes, _ = cv2.connectedComponentsWithStats(bright, connectivity=4)
    dots = [box for box in boxes[1:] if _is_dot(box, window.shape, radius)]
    if not dots:
        return lost
    area = np.pi * radius**2
    return np.array([left, top]) + _centre(
        window, min(dots, key=lambda box: abs(box[cv2.CC_STAT_AREA] - area)), radius
    )


def _is_dot(box: IntArray, shape: tuple[int, ...], radius: float) -> bool:
    """Whether a component's left, top, width, height and area, shape (5,), are those of a dot all around in view."""
    left, top, width, height, area = (int(value) for value in box)
    rim = _RIM * radius
    return (
        min(left, top) >= rim
        and left + width <= shape[1] - rim
        and top + height <= shape[0] - rim
        and _AREA[0] < area / (np.pi * radius**2) < _AREA[1]
        and min(width, height) >= _SLIM * max(width, height)
        and area >= _FULL * width * height
    )


def _centre(window: ByteArray, box: IntArray, radius: float) -> FloatArray:
    """Centre of light of the dot in a box of a window, shape (h, w); u, v [px], shape (2,)."""
    left, top, width, height = box[:4].tolist()
    rim = int(_RIM * radius)
    left, top, width, height = left - rim, top - rim, width + 2 * rim, height + 2 * rim
    cut = window[top : top + height, left : left + width].astype(float)
    u, v = np.arange(float(width)), np.arange(float(height))
    away = np.add.outer(np.square(v - 0.5 * (height - 1)), np.square(u - 0.5 * (width - 1)))
    outside, inside = cut[away > ((1 + 0.7 * _RIM) * radius) ** 2], cut[away < (0.6 * radius) ** 2]
    if not outside.size:
        return np.full(2, np.nan)
    dark, light = _median(outside), _median(inside)
    if light - dark < _CONTRAST:
        return np.full(2, np.nan)
    # Beyond the ring there may be anything; half way into it nothing of the dot is left.
    weight = cut - dark
    weight /= light - dark
    np.minimum(np.maximum(weight, 0.0, out=weight), 1.0, out=weight)
    weight *= away < ((1 + _RIM) * radius) ** 2
    columns, rows = weight.sum(axis=0), weight.sum(axis=1)
    total = columns.sum()
    return np.array([left + columns.dot(u) / total, top + rows.dot(v) / total])


def _median(values: FloatArray) -> float:
    """Median of a few values (n,), without the checks on which NumPy's own spends most of its time; sorts them."""
    values.sort()
    middle = values.size // 2
    return 0.5 * float(values[middle] + values[values.size - 1 - middle])
