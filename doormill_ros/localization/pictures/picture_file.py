"""Pictures as files: grey in, drawn ones out."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray
from doormill_ros.files import write_atomically
from doormill_ros.localization.errors import BadPicture
from doormill_ros.localization.pictures.compressed import unpacked


def read_picture(path: Path) -> ByteArray:
    """Grey picture, shape (h, w), from a PNG or JPEG file, read as a message with the same bytes is.

    Raises:
        BadPicture: There is no such file, it holds no picture, or a damaged one.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise BadPicture(
            f"{path} is no picture that can be read ({error.strerror}); give PNG or JPEG", path=str(path)
        ) from error
    try:
        return unpacked(data)
    except BadPicture as error:
        raise BadPicture(f"{path}: {error.message}", path=str(path)) from error


def write_picture(picture: ByteArray, path: Path) -> None:
    """Write an rgb picture, shape (h, w, 3), as the file's suffix says: .png or .jpg.

    Raises:
        BadPicture: The suffix is of no kind of picture.
        OSError: The file cannot be written.
    """
    try:
        _, data = cv2.imencode(path.suffix, np.ascontiguousarray(picture[..., ::-1]))
    except cv2.error as error:
        raise BadPicture(
            f"the picture {path} has the suffix {path.suffix!r}, allowed are .png and .jpg", path=str(path)
        ) from error
    write_atomically(path, data.tobytes())
