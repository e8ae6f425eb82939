"""Pictures of the empty clamp, with which those of doors are compared: section `empty_clamp` of a camera file."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray, Float32Array
from doormill_ros.localization.errors import BadCameraFile, BadPicture
from doormill_ros.localization.picture_file import read_picture
from doormill_ros.units import m_to_mm
from doormill_ros.values import Count, Name, NotNegative, Positive, Section

if TYPE_CHECKING:
    from doormill_ros.localization.camera import CameraModel

SAME_WIDTH = 1.0e-4  #: of two doors for which the slider stands in one place: half of it moves the camera [m]
_ALONG = 9  # px along an edge that are averaged


@dataclass(frozen=True)
class EmptyClampEntry(Section):
    """What the file says of one picture.

    Attributes:
        width: Door width for which the slider stood [m].
        picture: Its file, from the folder of the camera file.
        noise: Standard deviation of one of its pixels [grey levels].
        count: Pictures that were averaged.
    """

    width: Positive
    picture: Name
    noise: NotNegative = 0.0
    count: Count = 1


@dataclass(frozen=True, eq=False)
class EmptyClamp:
    """The clamp without a door, the slider standing for one width.

    Attributes:
        width: That door width [m].
        picture: Grey picture, shape (h, w), uint8.
        camera: The camera that took it, whole sensor.
        down: The picture averaged down its columns, as the hinge edge runs, shape (h, w).
        across: The picture averaged across its rows, as the bottom edge runs, shape (h, w).
    """

    width: float
    picture: ByteArray
    camera: CameraModel
    down: Float32Array = field(init=False)
    across: Float32Array = field(init=False)

    def __post_init__(self) -> None:
        """Average once what every picture is held against."""
        exact = self.picture.astype(np.float32)
        object.__setattr__(self, "down", cv2.blur(exact, (1, _ALONG)))
        object.__setattr__(self, "across", cv2.blur(exact, (_ALONG, 1)))


def load_empty_clamps(
    entries: tuple[EmptyClampEntry, ...], folder: Path, camera: CameraModel
) -> tuple[EmptyClamp, ...]:
    """Read the pictures that a camera file names.

    Args:
        entries: What the file says of them.
        folder: From which their paths are.
        camera: The file's camera.

    Raises:
        BadCameraFile: One cannot be read, or is of another size than the camera's.
    """
    found = []
    for i, entry in enumerate(entries):
        path = folder / entry.picture
        advice = "take it again with calibrate empty, or remove the entry"
        try:
            picture = read_picture(path)
        except BadPicture as error:
            raise BadCameraFile(f"empty_clamp.{i}: {error.message}; {advice}") from error
        size = (picture.shape[1], picture.shape[0])
        if size != camera.size:
            raise BadCameraFile(
                f"empty_clamp.{i}: {path} has {size[0]} x {size[1]} px, allowed are the camera's "
                f"{camera.size[0]} x {camera.size[1]}; {advice}"
            )
        found.append(EmptyClamp(entry.width, picture, camera))
    return tuple(found)


def empty_clamp_for(camera: CameraModel, width: float) -> EmptyClamp | None:
    """The empty clamp as it is seen when the slider stands for a door of that width [m]; None when no picture is."""
    near = [clamp for clamp in camera.empty if abs(clamp.width - width) <= SAME_WIDTH]
    return min(near, key=lambda clamp: abs(clamp.width - width), default=None)


def widths_told(clamps: tuple[EmptyClamp, ...]) -> str:
    """Widths with a picture, for people."""
    return ", ".join(f"{m_to_mm(clamp.width):g} mm" for clamp in clamps) or "none"
