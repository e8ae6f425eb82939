"""Pictures and camera models."""

from __future__ import annotations

import array

import numpy as np
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

from doormill_ros.arrays import ByteArray, FloatArray


def picture_message(picture: ByteArray, header: Header) -> Image:
    """mono8 from shape (height, width), rgb8 from shape (height, width, 3); uint8."""
    height, width = picture.shape[:2]
    channels = 1 if picture.ndim == 2 else 3
    message = Image(
        header=header,
        height=height,
        width=width,
        encoding="mono8" if channels == 1 else "rgb8",
        is_bigendian=0,
        step=width * channels,
    )
    # A list or bytes would be copied element by element.
    message.data = array.array("B", np.ascontiguousarray(picture, dtype=np.uint8).tobytes())
    return message


def camera_info_message(
    k: FloatArray, distortion: FloatArray, size: tuple[int, int], header: Header
) -> CameraInfo:
    """Intrinsics and distortion (plumb_bob) of a camera.

    Args:
        k: Camera matrix, shape (3, 3) [pixels].
        distortion: k1, k2, p1, p2, k3, shape (5,).
        size: Width and height [pixels].
        header: Of the picture that it goes with.
    """
    width, height = size
    p = np.hstack([k, np.zeros((3, 1))])
    return CameraInfo(
        header=header,
        width=int(width),
        height=int(height),
        distortion_model="plumb_bob",
        d=[float(v) for v in distortion],
        k=[float(v) for v in np.ravel(k)],
        r=[float(v) for v in np.eye(3).ravel()],
        p=[float(v) for v in p.ravel()],
    )
