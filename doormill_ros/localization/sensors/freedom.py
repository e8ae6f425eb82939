"""What the clamp leaves open and how far, for refusals and for sensors that are blind somewhere."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import StrictBool

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.config import read
from doormill_ros.frames import twist_between
from doormill_ros.localization.sensors.errors import BadSensorFile, PoseOutOfRange
from doormill_ros.localization.sensors.sensed_door import DEGREES_OF_FREEDOM
from doormill_ros.recipes.door import DoorSize
from doormill_ros.resources import resource
from doormill_ros.units import m_to_mm, rad_to_deg
from doormill_ros.values import NotNegative, Section

FORM = "config/sensors/clamp.yaml"


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


@dataclass(frozen=True)
class _Figures(Section):
    x: NotNegative  # [m]
    tilt: NotNegative  # [rad]


@dataclass(frozen=True)
class _ClampFile(Section):
    limits: _Figures
    held: _Figures
    measured: StrictBool = False


def load_freedom(layout: CellLayout, path: Path | None = None) -> ClampFreedom:
    """Read config/sensors/clamp.yaml; y, z and rotation x are limited by the cell.

    Raises:
        BadSensorFile: A key is missing or unknown, or a value impossible.
    """
    content = read(path or resource(FORM), _ClampFile, BadSensorFile, f"compare it with {FORM}")
    place, limits, held = layout.limits, content.limits, content.held
    return ClampFreedom(
        limits=np.array([limits.x, place.y, place.z, place.rotation, limits.tilt, limits.tilt]),
        held=np.array([held.x, place.y, place.z, place.rotation, held.tilt, held.tilt]),
    )
