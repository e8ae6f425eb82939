"""A picture averaged down by four, in which doors are looked for and backgrounds compared."""

from __future__ import annotations

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray

DOWN = 4  #: px that are averaged along each axis


def quartered(picture: ByteArray) -> ByteArray:
    """A grey picture (h, w), uint8, averaged down by halvings, which the library does fast; shape (h / 4, w / 4)."""
    height, width = (side // DOWN for side in picture.shape)
    half = cv2.resize(
        picture[: height * DOWN, : width * DOWN], (2 * width, 2 * height), interpolation=cv2.INTER_AREA
    )
    return np.asarray(cv2.resize(half, (width, height), interpolation=cv2.INTER_AREA), dtype=np.uint8)
