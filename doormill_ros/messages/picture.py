"""Pictures of any camera, as they are or compressed, to the 8 bit grey that doors are found in.

Works on sensor_msgs/Image and sensor_msgs/CompressedImage by the names of their fields, see `from_message`.
Encodings are those of sensor_msgs/image_encodings.hpp; the two colours in the name of a Bayer pattern's
OpenCV constant are those of the second row's second and third pixel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray
from doormill_ros.localization.errors import BadPicture
from doormill_ros.localization.lens import SMALLEST
from doormill_ros.localization.pictures.compressed import Pixels, compressed_size, in_bytes, unpacked


@dataclass(frozen=True)
class _Encoding:
    """Samples of each pixel, their bytes, and OpenCV's way to grey; None for grey itself."""

    channels: int = 1
    bytes: int = 1
    to_grey: int | None = None


_MOSAICS = {
    "rggb": cv2.COLOR_BayerBG2GRAY,
    "bggr": cv2.COLOR_BayerRG2GRAY,
    "gbrg": cv2.COLOR_BayerGR2GRAY,
    "grbg": cv2.COLOR_BayerGB2GRAY,
}
_COLOURS = {
    "rgb": (3, cv2.COLOR_RGB2GRAY),
    "bgr": (3, cv2.COLOR_BGR2GRAY),
    "rgba": (4, cv2.COLOR_RGBA2GRAY),
    "bgra": (4, cv2.COLOR_BGRA2GRAY),
}
ENCODINGS: dict[str, _Encoding] = {
    "mono8": _Encoding(),
    "8UC1": _Encoding(),
    "mono16": _Encoding(bytes=2),
    "16UC1": _Encoding(bytes=2),
    **{f"{n}{8 * b}": _Encoding(c, b, code) for n, (c, code) in _COLOURS.items() for b in (1, 2)},
    **dict.fromkeys(("yuv422", "uyvy"), _Encoding(2, 1, cv2.COLOR_YUV2GRAY_UYVY)),
    **dict.fromkeys(("yuv422_yuy2", "yuyv"), _Encoding(2, 1, cv2.COLOR_YUV2GRAY_YUY2)),
    **{f"bayer_{n}{8 * b}": _Encoding(1, b, code) for n, code in _MOSAICS.items() for b in (1, 2)},
}


def packed_size(message: Any) -> tuple[int, int] | None:
    """Width and height [px] of a compressed picture, of which nothing is unpacked; None for one as it is.

    Raises:
        BadPicture: It has no header that can be read.
    """
    return compressed_size(bytes(message.data[:_HEADERS])) if _is_compressed(message) else None


def picture_of(message: Any) -> ByteArray:
    """Grey picture, shape (height, width) uint8, from a sensor_msgs/Image or sensor_msgs/CompressedImage.

    Raises:
        BadPicture: An encoding that is not read here, too few bytes, or a compressed picture that is none.
    """
    if _is_compressed(message):
        return unpacked(bytes(message.data))
    encoding = ENCODINGS.get(message.encoding)
    if encoding is None:
        raise BadPicture(
            f"picture has encoding {message.encoding!r}, allowed are {', '.join(ENCODINGS)}; "
            "set the camera driver to mono8",
            encoding=message.encoding,
        )
    rows = _samples(message, encoding)
    if encoding.to_grey is None:
        return in_bytes(rows)
    if encoding.channels > 1:
        return in_bytes(cv2.cvtColor(rows.reshape(*rows.shape[:1], -1, encoding.channels), encoding.to_grey))
    if min(rows.shape) < SMALLEST:
        raise BadPicture(
            f"picture of {message.width} x {message.height} px is a Bayer pattern, allowed are {SMALLEST} px and more; "
            "check the camera driver"
        )
    return in_bytes(cv2.cvtColor(rows, encoding.to_grey))


def colours_of(message: Any) -> ByteArray:
    """Colour picture, shape (height, width, 3) uint8, from a sensor_msgs/Image in rgb8.

    Raises:
        BadPicture: Another encoding, or too few bytes.
    """
    if message.encoding != "rgb8":
        raise BadPicture(f"picture has encoding {message.encoding!r}, allowed is rgb8; send it in colours")
    return _rows(message, 3).reshape(message.height, message.width, 3)


_HEADERS = 1 << 20  # bytes in which the header of a compressed picture is looked for


def _is_compressed(message: Any) -> bool:
    return not hasattr(message, "encoding")


def _samples(message: Any, encoding: _Encoding) -> Pixels:
    """Samples of the pixels, shape (height, width * channels), in this machine's order of bytes."""
    rows = _rows(message, encoding.channels * encoding.bytes)
    if encoding.bytes == 1:
        return rows
    order = ">u2" if message.is_bigendian else "<u2"
    return np.ascontiguousarray(rows).view(order).astype(np.uint16)


def _rows(message: Any, pixel: int) -> ByteArray:
    """Bytes of the pixels, shape (height, width * pixel), of `pixel` bytes each."""
    data = np.frombuffer(message.data, dtype=np.uint8)
    if (
        not message.width
        or not message.height
        or message.step < message.width * pixel
        or data.size < message.height * message.step
    ):
        raise BadPicture(
            f"picture of {message.width} x {message.height} pixels came with {data.size} bytes in rows of "
            f"{message.step}, needed are {message.height * message.width * pixel}; check the camera driver",
            size=int(data.size),
        )
    rows: ByteArray = data[: message.height * message.step].reshape(message.height, message.step)
    return rows[:, : message.width * pixel]
