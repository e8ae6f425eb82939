"""A door found by the cell's own localizer or by any sensor, in one form; several of them side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.cell.places.layout import OFFSETS, CellLayout
from doormill_ros.frames import twist_between
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.repeatability import Repeatability, repeatability
from doormill_ros.localization.result import Localization
from doormill_ros.localization.sensors.readings import Reading
from doormill_ros.localization.sensors.sensed_door import DEGREES_OF_FREEDOM
from doormill_ros.localization.sensors.sensor import DoorSensor
from doormill_ros.localization.settings import LocalizerSettings
from doormill_ros.recipes.door import DoorSize


@dataclass(frozen=True, eq=False)
class LocatedDoor:
    """Where a door stands.

    Attributes:
        T_base_door: Its pose, shape (4, 4).
        freedoms: Names of the k degrees of freedom told, `OFFSETS` or `DEGREES_OF_FREEDOM`.
        offset: From the nominal place along them, shape (k,) [m, rad].
        covariance: Of `offset`, shape (k, k).
        own_covariance: What another reading of the same door draws anew, as far as it is known apart, shape (k, k).
        blind: Names of those that were not measured.
        facts: Residual [m], quality and the like, by name.
        localization: What the localizer found in the picture; None of another sensor.
    """

    T_base_door: FloatArray
    freedoms: tuple[str, ...]
    offset: FloatArray
    covariance: FloatArray
    own_covariance: FloatArray
    blind: tuple[str, ...] = ()
    facts: dict[str, float] = field(default_factory=dict)
    localization: Localization | None = None

    @property
    def deviations(self) -> FloatArray:
        """Standard deviations of `offset`, shape (k,) [m, rad]."""
        return np.sqrt(np.diag(self.covariance))


def locate_in_picture(
    picture: ByteArray, camera: CameraModel, layout: CellLayout, door: DoorSize, settings: LocalizerSettings
) -> LocatedDoor:
    """Find the door as the cell does.

    Args:
        picture: Grey picture, shape (h, w).
        camera: The camera.
        layout: Where the nominal door stands.
        door: Its size.
        settings: Limits of refusal, and what the picture cannot tell.

    Raises:
        LocalizationError: The reason for a refusal.
    """
    found = localize(picture, camera, layout, door.width, door.thickness, settings=settings)
    return LocatedDoor(
        T_base_door=found.T_base_door,
        freedoms=OFFSETS,
        offset=np.array([found.offset.y, found.offset.z, found.offset.rotation]),
        covariance=found.covariance,
        own_covariance=found.parts.scatter,  # the rest is the same in every picture of this door
        facts={"residual": found.residual, "inlier_share": found.inlier_share, "quality": found.quality},
        localization=found,
    )


def locate_with_sensor(
    sensor: DoorSensor, reading: Reading, layout: CellLayout, door: DoorSize
) -> LocatedDoor:
    """Find the door by a sensor.

    Args:
        sensor: Any of the registry.
        reading: Of the kind that it takes.
        layout: Where the nominal door stands.
        door: Its size.

    Raises:
        LocalizationError: The reason for a refusal.
    """
    estimate = sensor.locate(reading.value, door)
    facts = {"redundancy": float(estimate.redundancy), "seconds": estimate.seconds}
    if estimate.redundancy > 0 and np.isfinite(estimate.chi_square):
        facts["chi_square"] = estimate.chi_square
    facts |= {
        name: float(value) for name, value in estimate.details.items() if isinstance(value, int | float)
    }
    return LocatedDoor(
        T_base_door=estimate.T_base_door,
        freedoms=DEGREES_OF_FREEDOM,
        offset=twist_between(layout.T_base_door(door.width, door.thickness), estimate.T_base_door),
        covariance=estimate.covariance,
        own_covariance=estimate.covariance,
        blind=estimate.blind,
        facts=facts,
    )


def compare_located(doors: Sequence[LocatedDoor]) -> tuple[tuple[str, ...], Repeatability]:
    """Spread of the same door found at least twice in the same way: which degrees of freedom, and how far."""
    first = doors[0]
    seen = [i for i, name in enumerate(first.freedoms) if name not in first.blind]
    poses = np.array([one.offset[seen] for one in doors])
    covariances = np.array([one.own_covariance[np.ix_(seen, seen)] for one in doors])
    return tuple(first.freedoms[i] for i in seen), repeatability(poses, covariances)
