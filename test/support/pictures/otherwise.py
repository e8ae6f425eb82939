"""A picture as cameras send it whose grey levels are rounded otherwise; the door stays where it was."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray

_BROWN = np.array([1.25, 1.0, 0.62]) / 1.03  # red, green and blue of wood, as shares of its grey
_DARKER = 0.75  # keeps the red of a bright face from clipping
_TWELVE = 4095.0 / 255.0


def _colours(grey: ByteArray) -> np.ndarray:
    return _DARKER * grey[..., None].astype(np.float32) * _BROWN.astype(np.float32)


def deep_colours(grey: ByteArray) -> ByteArray:
    """Of a colour camera of 12 bits; grey levels (h, w), as in all of these."""
    deep = cv2.cvtColor(np.rint(_TWELVE * _colours(grey)).astype(np.uint16), cv2.COLOR_RGB2GRAY)
    return cv2.convertScaleAbs(deep, alpha=1.0 / _TWELVE)


def mosaic(grey: ByteArray) -> ByteArray:
    """Of a colour camera with a Bayer pattern."""
    colours = _colours(grey)
    seen = np.empty(grey.shape, np.uint8)
    for place, colour in enumerate((0, 1, 1, 2)):
        row, column = divmod(place, 2)
        seen[row::2, column::2] = np.rint(colours[row::2, column::2, colour])
    return cv2.cvtColor(seen, cv2.COLOR_BayerBG2GRAY)


def darker(grey: ByteArray) -> ByteArray:
    """In light that is a third less, so that some of the 256 levels become one."""
    return np.rint(grey * (2.0 / 3.0)).astype(np.uint8)


def bent(gamma: float) -> Callable[[ByteArray], ByteArray]:
    """By a camera whose response is not quite linear."""
    table = np.rint(255.0 * (np.arange(256) / 255.0) ** gamma).astype(np.uint8)
    return lambda grey: table[grey]


def noisier(grey: ByteArray) -> ByteArray:
    """With one grey level more of noise."""
    noise = np.random.default_rng(8).standard_normal(grey.shape, dtype=np.float32)
    return cv2.convertScaleAbs(cv2.max(grey + noise, 0.0))


OTHERWISE: dict[str, Callable[[ByteArray], ByteArray]] = {
    "as it is": lambda grey: grey,
    "colours of 12 bits": deep_colours,
    "Bayer pattern": mosaic,
    "a third darker": darker,
    "gamma 0.97": bent(0.97),
    "gamma 1.03": bent(1.03),
    "noisier": noisier,
}
