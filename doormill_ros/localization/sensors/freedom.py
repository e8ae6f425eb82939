"""What the clamp leaves open and how far, for refusals and for sensors that are blind somewhere."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.layout import CellLayout
from doormill_ros.frames import twist_between
from doormill_ros.localization.sensors.errors import BadSensorFile, PoseOutOfRange
from doormill_ros.localization.sensors.sensor import DEGREES_OF_FREEDOM
from doormill_ros.recipes.door import DoorSize
from doormill_ros.resources import resource
from doormill_ros.units import m_to_mm, rad_to_deg


def read_sensor_file(path: Path) -> dict[str, Any]:
    """A sensor's YAML file.

    Raises:
        BadSensorFile: It holds no mapping.
    """
    document = yaml.safe_load(path.read_text(encoding="utf-8"))
    if not isinstance(document, dict):
        raise BadSensorFile(f"{path} holds no mapping; compare it with those in config/sensors")
    return document


@dataclass(frozen=True, eq=False)
class ClampFreedom:
    """How far a clamped door may stand off.

    Attributes:
        limits: Largest absolute twist from the nominal place, shape (6,) [m, rad].
        held: Standard deviations of what the clamp guarantees, shape (6,) [m, rad].
    """

    limits: FloatArray
    held: FloatArray

    def check(
        self, T_base_door: FloatArray, deviations: FloatArray, layout: CellLayout, door: DoorSize
    ) -> None:
        """Refuse a pose that the clamp cannot hold, three of its standard deviations (6,) allowed for.

        Raises:
            PoseOutOfRange: One degree of freedom is beyond its limit.
        """
        twist = twist_between(layout.T_base_door(door.width, door.thickness), T_base_door)
        for i, name in enumerate(DEGREES_OF_FREEDOM):
            if abs(twist[i]) > self.limits[i] + 3.0 * deviations[i]:
                to_unit, unit = (m_to_mm, "mm") if i < 3 else (rad_to_deg, "deg")
                raise PoseOutOfRange(
                    f"the door is off by {to_unit(twist[i]):.2f} {unit} in {name}, allowed are "
                    f"{to_unit(self.limits[i]):.2f} {unit}; clamp it again",
                    degree_of_freedom=name,
                )


def load_freedom(layout: CellLayout, path: Path | None = None) -> ClampFreedom:
    """Read config/sensors/clamp.yaml; y, z and rotation x are limited by the cell.

    Raises:
        BadSensorFile: A key is missing.
    """
    path = path or resource("config/sensors/clamp.yaml")
    document = read_sensor_file(path)
    try:
        x, tilt = float(document["limits"]["x"]), float(document["limits"]["tilt"])
        held_x, held_tilt = float(document["held"]["x"]), float(document["held"]["tilt"])
    except (KeyError, TypeError, ValueError) as error:
        raise BadSensorFile(f"{path} lacks {error}; compare it with config/sensors/clamp.yaml") from error
    place = layout.limits
    return ClampFreedom(
        limits=np.array([x, place.y, place.z, place.rotation, tilt, tilt]),
        held=np.array([held_x, place.y, place.z, place.rotation, held_tilt, held_tilt]),
    )
