"""JPEG and PNG, from a message or a file: what they hold is asked before anything of it is unpacked."""

from __future__ import annotations

import struct

import cv2
import numpy as np
from numpy.typing import NDArray

from doormill_ros.arrays import BoolArray, ByteArray
from doormill_ros.localization.errors import BadPicture

#: Bits that cameras fill of the 16 that hold a pixel. Nothing in a picture says how many, hence as few as
#: hold the brightest pixel: a factor on the light of a whole picture moves no edge.
DEPTHS = (10, 12, 14, 16)
MOST_PIXELS = 100_000_000  # more than any camera in use has
_PNG, _JPEG = b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff"
_PNG_SIZE = struct.Struct(">8xI4sII")  # signature, length and name of the first chunk, width, height
_JPEG_SIZE = struct.Struct(">BHH")  # bits, height, width
#: Frame headers of JPEG (ITU-T T.81 table B.1) but for those of lossless and hierarchical ones.
_FRAMES = (0xC0, 0xC1, 0xC2)
_ALONE = (0x01, *range(0xD0, 0xD9))  # markers without a length
_SCAN, _END = 0xDA, 0xD9
_MOST_SCANS = 64  # each goes through the whole picture; a progressive one has about ten
_LOST = 128  # grey level that a decoder puts where data are lost
_BLOCK = 8  # rows of a block

Pixels = NDArray[np.uint8] | NDArray[np.uint16]


def compressed_size(data: bytes) -> tuple[int, int]:
    """Width and height [px] by the header of a JPEG or PNG.

    Raises:
        BadPicture: It is neither, is cut off, or holds more than a camera sends.
    """
    if data.startswith(_PNG) and len(data) >= _PNG_SIZE.size:
        _, name, width, height = _PNG_SIZE.unpack_from(data)
        size = (width, height) if name == b"IHDR" else None
    else:
        size = _jpeg_size(data) if data.startswith(_JPEG) else None
    if size is None:
        raise BadPicture(
            f"a compressed picture of {len(data)} bytes begins with {data[:8].hex(' ') or 'nothing'}, allowed are JPEG "
            "and PNG; set the image transport to compressed and its format to jpeg or png, or save a file as one of "
            "these"
        )
    if not 0 < size[0] * size[1] <= MOST_PIXELS:
        raise BadPicture(
            f"a compressed picture says that it has {size[0]} x {size[1]} px, allowed are 1 to {MOST_PIXELS} px; "
            "check the camera driver",
            size=size,
        )
    return size


def _jpeg_size(data: bytes) -> tuple[int, int] | None:
    """By the first frame header; None where there is none."""
    at = 2
    while at + 4 <= len(data) and data[at] == 0xFF:
        marker = data[at + 1]
        if marker == 0xFF:  # fill
            at += 1
        elif marker in _ALONE:
            at += 2
        elif marker in _FRAMES and at + 4 + _JPEG_SIZE.size <= len(data):
            _, height, width = _JPEG_SIZE.unpack_from(data, at + 4)
            return width, height
        elif marker in (_SCAN, _END):
            return None
        else:
            at += 2 + int.from_bytes(data[at + 2 : at + 4], "big")
    return None


def in_bytes(pixels: Pixels) -> ByteArray:
    """Pixels of 8 bits, shape (height, width); of deeper ones the brightest fills most of them."""
    if pixels.dtype == np.uint8:
        return np.ascontiguousarray(pixels, dtype=np.uint8)
    bits = next(bits for bits in DEPTHS if int(pixels.max()) < 1 << bits)
    grey: ByteArray = cv2.convertScaleAbs(pixels, alpha=255.0 / ((1 << bits) - 1))
    return grey


def unpacked(data: bytes) -> ByteArray:
    """Grey picture, shape (height, width) uint8, of a JPEG or PNG.

    Raises:
        BadPicture: It is neither, holds more than a camera sends, or is damaged.
    """
    return in_bytes(decoded(data))


def decoded(data: bytes) -> Pixels:
    """Grey levels of a JPEG or PNG, shape (height, width), as deep as it holds them; never turned by what it says.

    Raises:
        BadPicture: It is neither, holds more than a camera sends, or is damaged.
    """
    size = compressed_size(data)
    jpeg = data.startswith(_JPEG)
    if jpeg:
        _require_whole(data)
    flags = cv2.IMREAD_ANYDEPTH | cv2.IMREAD_IGNORE_ORIENTATION
    try:
        pixels = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), flags)
    except cv2.error:
        pixels = None
    if pixels is None or pixels.shape != size[::-1] or pixels.dtype not in (np.uint8, np.uint16):
        raise BadPicture(
            f"a compressed picture of {size[0]} x {size[1]} px and {len(data)} bytes cannot be unpacked; it is "
            "damaged, check the line to the camera"
        )
    if jpeg and _lost(pixels == _LOST):
        raise BadPicture(
            f"a JPEG of {size[0]} x {size[1]} px has lost a part of its data: the grey of a decoder stands in its "
            "place; check the line to the camera"
        )
    return np.asarray(pixels)


def _require_whole(data: bytes) -> None:
    """The end of the picture has come, and it does not go through itself without end."""
    scans, end = data.count(bytes([0xFF, _SCAN])), data.rfind(bytes([0xFF, _END]))
    if end < data.rfind(bytes([0xFF, _SCAN])):
        raise BadPicture(
            f"a JPEG of {len(data)} bytes ends before its picture does; check the line to the camera"
        )
    if scans > _MOST_SCANS:
        raise BadPicture(
            f"a JPEG holds {scans} scans of its picture, allowed are {_MOST_SCANS}; check the camera driver"
        )


def _lost(grey: BoolArray) -> bool:
    """Whether the last blocks or whole rows of blocks, shape (height, width), are but what a decoder fills in.

    Where data are missing, those behind come too early, and the end has none.
    """
    if grey[-_BLOCK:, -4 * _BLOCK :].all():
        return True
    rows = np.convolve(grey.all(axis=1), np.ones(_BLOCK), mode="valid")
    return bool((rows == _BLOCK).any())
