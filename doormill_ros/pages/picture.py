"""Pictures in a form that browsers show."""

from __future__ import annotations

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray

LONGEST_SIDE = 1280  # pixels
MEDIA_TYPE = "image/jpeg"
#: With colours at full resolution: an overlay's lines are one pixel wide and would turn grey.
_OPTIONS = [
    cv2.IMWRITE_JPEG_QUALITY,
    85,
    cv2.IMWRITE_JPEG_SAMPLING_FACTOR,
    cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444,
]


def encode_picture(picture: ByteArray) -> bytes:
    """JPEG of a picture, made smaller where a tablet would not show more.

    Args:
        picture: Grey, shape (height, width), or red-green-blue, shape (height, width, 3); uint8.
    """
    step = -(-max(picture.shape[:2]) // LONGEST_SIDE)
    if step > 1:
        height, width = picture.shape[:2]
        picture = cv2.resize(picture, (width // step, height // step), interpolation=cv2.INTER_AREA)
    if picture.ndim == 3:
        picture = picture[..., ::-1]
    _, jpeg = cv2.imencode(".jpg", np.ascontiguousarray(picture), _OPTIONS)
    return bytes(jpeg)
