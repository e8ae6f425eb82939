"""Pictures of the empty clamp, with which those of doors are compared: section `empty_clamp` of a camera file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization.errors import BadCameraFile, BadPicture
from doormill_ros.localization.pictures.picture_file import read_picture
from doormill_ros.units import m_to_mm
from doormill_ros.values import Count, Name, NotNegative, Positive, Section

SAME_WIDTH = 1.0e-4  #: of two doors for which the slider stands in one place: half of it moves the camera [m]


@dataclass(frozen=True)
class EmptyClampEntry(Section):
    """What the file says of one picture.

    Attributes:
        width: Door width for which the slider stood [m].
        picture: Its file, from the folder of the camera file.
        noise: Standard deviation of one of its pixels [grey levels].
        count: Pictures that were averaged.
        taken: The day on which they were taken, for people.
    """

    width: Positive
    picture: Name
    noise: NotNegative = 0.0
    count: Count = 1
    taken: Name | None = None


@dataclass(frozen=True, eq=False)
class EmptyClamp:
    """The clamp without a door, the slider standing for one width.

    Attributes:
        width: That door width [m].
        picture: Grey picture, shape (h, w), uint8.
        k: Intrinsic matrix of the camera that took it [px], shape (3, 3).
        distortion: Its k1, k2, p1, p2, k3, shape (5,).
        taken: The day on which it was taken, for people; empty when nobody has said.
    """

    width: float
    picture: ByteArray
    k: FloatArray
    distortion: FloatArray
    taken: str = ""


def load_empty_clamps(
    entries: tuple[EmptyClampEntry, ...],
    folder: Path,
    k: FloatArray,
    distortion: FloatArray,
    size: tuple[int, int],
) -> tuple[EmptyClamp, ...]:
    """Read the pictures that a camera file names.

    Args:
        entries: What the file says of them.
        folder: From which their paths are.
        k: Intrinsic matrix of the file's camera [px], shape (3, 3).
        distortion: Its k1, k2, p1, p2, k3, shape (5,).
        size: Width and height of its pictures [px].

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
        if picture.shape[::-1] != size:
            raise BadCameraFile(
                f"empty_clamp.{i}: {path} has {picture.shape[1]} x {picture.shape[0]} px, allowed are the camera's "
                f"{size[0]} x {size[1]}; {advice}"
            )
        found.append(EmptyClamp(entry.width, picture, k, distortion, entry.taken or ""))
    return tuple(found)


def empty_clamp_for(clamps: tuple[EmptyClamp, ...], width: float) -> EmptyClamp | None:
    """The empty clamp as it is seen when the slider stands for a door of that width [m]; None when no picture is."""
    near = [clamp for clamp in clamps if abs(clamp.width - width) <= SAME_WIDTH]
    return min(near, key=lambda clamp: abs(clamp.width - width), default=None)


def widths_told(clamps: tuple[EmptyClamp, ...]) -> str:
    """Widths with a picture, for people."""
    return ", ".join(f"{m_to_mm(clamp.width):g} mm" for clamp in clamps) or "none"
