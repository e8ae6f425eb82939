"""The seam: what every door sensor is and what it answers."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np
from scipy.special import chdtri

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.localization.sensors.sensed_door import DEGREES_OF_FREEDOM
from doormill_ros.recipes.door import DoorSize
from doormill_ros.values import NotNegative, Section

#: What a sensor reads: a picture, one picture of each camera, distances along beams, or touched points.
ReadingKind = Literal["picture", "pictures", "distances", "points"]
#: Probability of a chi-square so large by chance at which readings count as contradicting each other.
CONTRADICTION = 1.0e-6


@dataclass(frozen=True, eq=False)
class DoorPoseEstimate:
    """Where a sensor says the door stands.

    Attributes:
        T_base_door: Pose of the door, shape (4, 4).
        covariance: Of the twist that `frames.apply_twist` needs to move the estimate onto the truth:
            translation of the door's origin [m], then rotation [rad], base axes, shape (6, 6). Where
            the sensor is blind it holds what the clamp guarantees.
        sees: Which degrees of freedom were measured, in the order of DEGREES_OF_FREEDOM.
        seconds: From the order to measure until the pose is known: motion, exposure and arithmetic [s].
        chi_square: Weighted sum of squared residuals; nan when the sensor does not say.
        redundancy: Readings beyond those needed; with 0 a wrong reading cannot be noticed.
        details: What else the sensor can tell, by name.
    """

    T_base_door: FloatArray
    covariance: FloatArray
    sees: tuple[bool, ...]
    seconds: float
    chi_square: float
    redundancy: int
    details: dict[str, Any] = field(default_factory=dict)

    @property
    def deviations(self) -> FloatArray:
        """Standard deviations in the order of DEGREES_OF_FREEDOM [m, rad], shape (6,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def quality(self) -> float:
        """Distance from a contradiction among the readings, 0..1; 1 where none is left over to contradict."""
        if self.redundancy <= 0 or not np.isfinite(self.chi_square):
            return 1.0
        return float(np.clip(1.0 - self.chi_square / chdtri(self.redundancy, CONTRADICTION), 0.0, 1.0))

    @property
    def blind(self) -> tuple[str, ...]:
        """Names of the degrees of freedom that were not measured."""
        return tuple(n for n, seen in zip(DEGREES_OF_FREEDOM, self.sees, strict=True) if not seen)


@dataclass(frozen=True)
class MountingDeviation(Section):
    """How well a camera is mounted: standard deviations of its place [m] and of its direction [rad], each axis."""

    position: NotNegative
    rotation: NotNegative


class DoorSensor(Protocol):
    """A way to find the door.

    Attributes:
        name: As in the registry.
        takes: What a reading of it is, as `readings.read_readings` reads it from a file.
        cannot_see: What it is blind for, in words.
    """

    @property
    def name(self) -> str: ...  # noqa: D102  fields of the class that is a sensor

    @property
    def takes(self) -> ReadingKind: ...  # noqa: D102

    @property
    def cannot_see(self) -> str: ...  # noqa: D102

    # Each sensor has arrays of its own; no type says more than Any of all of them.
    def locate(self, reading: Any, door: DoorSize) -> DoorPoseEstimate:
        """Pose of the door from one reading.

        Args:
            reading: Of the kind `takes`: a picture, shape (h, w), uint8; pictures by camera name; distances,
                shape (n,) [m]; or points in base axes, shape (n, 3) [m].
            door: The door in the clamp.

        Raises:
            LocalizationError: The reading gives no pose that can be trusted.
        """
        ...


class SensorLoader(Protocol):
    """Makes a sensor of its configuration file; None for the one that ships, and for the cell's layout."""

    def __call__(self, path: Path | None = None, layout: CellLayout | None = None) -> DoorSensor:
        """The sensor.

        Raises:
            BadSensorFile: The file lacks a key or holds a value out of bounds.
        """
        ...
