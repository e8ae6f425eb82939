"""Readings of a door sensor from files: a picture, or YAML with readings of the same door one after the other.

The YAML holds one key, which says what is read and in which unit:

    distances_mm: [[55.01, 54.98, 55.02, 55.00, 54.97, 55.03]]
    points_mm: [[[1599.9, -28.1, -0.2], ...]]
    pictures: [{"1": face.png, "2": bottom.png, "3": hinge.png}]
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.config import read
from doormill_ros.localization.pictures.picture_file import read_picture
from doormill_ros.localization.sensors.errors import BadReading
from doormill_ros.localization.sensors.sensor import ReadingKind
from doormill_ros.units import mm_to_m
from doormill_ros.values import FiniteNumber, Name, Section, Vector3

_ADVICE = "see docs/sensors.md"
Value = ByteArray | FloatArray | dict[str, ByteArray]


@dataclass(frozen=True, eq=False)
class Reading:
    """One reading of a door sensor.

    Attributes:
        name: The file it comes from, and its number there when there are several.
        value: What `DoorSensor.locate` takes: a picture, shape (h, w), one of each camera, distances, shape (n,) [m],
            or points, shape (n, 3) [m].
    """

    name: str
    value: Value


@dataclass(frozen=True)
class _Distance:
    """A number or nan in a model."""

    what: str = "a number of millimetres, .nan for a beam that meets nothing"

    def check(self, value: object) -> float:
        """The number; raises what pydantic expects of a validator."""
        if isinstance(value, float) and np.isnan(value):
            return value
        return FiniteNumber(self.what).check(value)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.check)


_AtLeastOne = Field(min_length=1)


@dataclass(frozen=True, eq=False)
class _Distances(Section):
    distances_mm: Annotated[tuple[tuple[Annotated[float, _Distance()], ...], ...], _AtLeastOne]

    def values(self, folder: Path) -> list[Value]:
        """In metres, each shape (n,)."""
        return [mm_to_m(np.array(row, dtype=float)) for row in self.distances_mm]


@dataclass(frozen=True, eq=False)
class _Points(Section):
    points_mm: Annotated[tuple[Annotated[tuple[Vector3, ...], _AtLeastOne], ...], _AtLeastOne]

    def values(self, folder: Path) -> list[Value]:
        """In metres, each shape (n, 3)."""
        return [mm_to_m(np.array(row)) for row in self.points_mm]


@dataclass(frozen=True, eq=False)
class _Pictures(Section):
    pictures: Annotated[tuple[dict[str | int, Name], ...], _AtLeastOne]

    def values(self, folder: Path) -> list[Value]:
        """By camera, each shape (h, w)."""
        return [
            {str(name): read_picture(folder / file) for name, file in row.items()} for row in self.pictures
        ]


_FORMS: dict[str, type[_Distances | _Points | _Pictures]] = {
    "distances": _Distances,
    "points": _Points,
    "pictures": _Pictures,
}


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
    values = read(path, _FORMS[takes], BadReading, _ADVICE).values(path.parent)
    several = len(values) > 1
    return [
        Reading(f"{path.name} reading {i + 1}" if several else path.name, v) for i, v in enumerate(values)
    ]
