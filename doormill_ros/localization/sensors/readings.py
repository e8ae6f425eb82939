"""Readings of a door sensor from files: a picture, or YAML with readings of the same door one after the other.

The YAML holds one key, which says what is read and in which unit:

    distances_mm: [[55.01, 54.98, 55.02, 55.00, 54.97, 55.03]]
    points_mm: [[[1599.9, -28.1, -0.2], ...]]
    pictures: [{"1": face.png, "2": bottom.png, "3": hinge.png}]
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.config import read_document
from doormill_ros.localization.picture_file import read_picture
from doormill_ros.localization.sensors.errors import BadReading
from doormill_ros.localization.sensors.sensor import ReadingKind
from doormill_ros.units import mm_to_m


@dataclass(frozen=True, eq=False)
class Reading:
    """One reading of a door sensor.

    Attributes:
        name: The file it comes from, and its number there when there are several.
        value: What `DoorSensor.locate` takes.
    """

    name: str
    value: ByteArray | FloatArray | dict[str, ByteArray]


def read_readings(path: Path, takes: ReadingKind) -> list[Reading]:
    """The readings in a file, at least one.

    Args:
        path: A picture (PNG or JPEG) for the kind "picture", a YAML file for every other.
        takes: What the sensor reads.

    Raises:
        BadPicture: A picture cannot be read.
        BadReading: The file cannot be read or holds something else.
    """
    if takes == "picture":
        return [Reading(path.name, read_picture(path))]
    key, parse = _FORMS[takes]
    rows = _document(path, key)
    readings = []
    for i, row in enumerate(rows):
        try:
            value = parse(row, path.parent)
        except (TypeError, ValueError, OverflowError) as error:
            raise BadReading(
                f"{path}: reading {i + 1} of {key} is {row!r}, {error}", path=str(path)
            ) from error
        readings.append(Reading(path.name if len(rows) == 1 else f"{path.name} reading {i + 1}", value))
    return readings


def _document(path: Path, key: str) -> list[Any]:
    document = read_document(path, BadReading, "see docs/sensors.md")
    if not isinstance(document, dict) or list(document) != [key]:
        found = list(document) if isinstance(document, dict) else type(document).__name__
        raise BadReading(f"{path} holds {found}, allowed is the one key {key}; see docs/sensors.md")
    rows = document[key]
    if not isinstance(rows, list) or not rows:
        raise BadReading(f"{path}: {key} is {rows!r}, allowed is a list of at least one reading")
    return rows


def _distances(row: Any, _: Path) -> FloatArray:
    values = np.array(row, dtype=float)
    if values.ndim != 1:
        raise ValueError("allowed is a list of distances [mm], .nan for a beam that meets nothing")
    return mm_to_m(values)


def _points(row: Any, _: Path) -> FloatArray:
    values = np.array(row, dtype=float)
    if values.ndim != 2 or values.shape[1] != 3:
        raise ValueError("allowed is a list of points x, y, z [mm]")
    return mm_to_m(values)


def _pictures(row: Any, folder: Path) -> dict[str, ByteArray]:
    if not isinstance(row, dict) or not all(isinstance(name, str) for name in row.values()):
        raise ValueError("allowed is a mapping of camera names to picture files beside this file")
    return {str(camera): read_picture(folder / name) for camera, name in row.items()}


#: For each kind that stands in YAML, the key and what turns one reading into arrays in SI.
_FORMS: dict[str, tuple[str, Callable[[Any, Path], FloatArray | dict[str, ByteArray]]]] = {
    "distances": ("distances_mm", _distances),
    "points": ("points_mm", _points),
    "pictures": ("pictures", _pictures),
}
