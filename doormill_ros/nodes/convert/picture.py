"""Pictures and camera models."""

from __future__ import annotations

import array

import numpy as np
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.errors import BadPicture

CHANNELS = {"mono8": 1, "8UC1": 1, "rgb8": 3, "bgr8": 3}
GREY = {"rgb8": np.array([0.299, 0.587, 0.114]), "bgr8": np.array([0.114, 0.587, 0.299])}


def picture_of(message: Image) -> np.ndarray:
    """Grey picture, shape (height, width) uint8.

    Raises:
        BadPicture: An encoding other than mono8, 8UC1, rgb8 or bgr8, or too few bytes.
    """
    channels = CHANNELS.get(message.encoding)
    if channels is None:
        raise BadPicture(
            f"picture has encoding {message.encoding!r}, allowed are {', '.join(CHANNELS)}; "
            "set the camera driver to mono8",
            encoding=message.encoding,
        )
    data = np.frombuffer(message.data, dtype=np.uint8)
    if message.step < message.width * channels or data.size < message.height * message.step:
        raise BadPicture(
            f"picture of {message.width} x {message.height} pixels came with {data.size} bytes in rows of "
            f"{message.step}, needed are {message.height * message.width * channels}; check the camera driver",
            size=int(data.size),
        )
    rows = data[: message.height * message.step].reshape(message.height, message.step)
    rows = rows[:, : message.width * channels]
    if channels == 1:
        return np.ascontiguousarray(rows)
    colour = rows.reshape(message.height, message.width, 3)
    return (colour @ GREY[message.encoding] + 0.5).astype(np.uint8)


def picture_message(picture: np.ndarray, header: Header) -> Image:
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


def camera_info_message(camera: CameraModel, header: Header) -> CameraInfo:
    """Intrinsics and distortion (plumb_bob) of a camera model."""
    width, height = camera.size
    k = np.asarray(camera.k, dtype=float)
    p = np.hstack([k, np.zeros((3, 1))])
    return CameraInfo(
        header=header,
        width=int(width),
        height=int(height),
        distortion_model="plumb_bob",
        d=[float(v) for v in camera.distortion],
        k=[float(v) for v in k.ravel()],
        r=[float(v) for v in np.eye(3).ravel()],
        p=[float(v) for v in p.ravel()],
    )
