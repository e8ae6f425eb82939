"""What one sensor says of where the door stands."""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.arrays import FloatArray

DEGREES_OF_FREEDOM = ("x", "y", "z", "rotation x", "rotation y", "rotation z")


@dataclass(frozen=True, eq=False)
class SensedDoor:
    """Where one sensor has the door.

    Attributes:
        sensor: Its name.
        T_base_door: The pose, shape (4, 4).
        covariance: Of the twist from there to the truth, base axes, shape (6, 6); read where the sensor sees.
        sees: Which degrees of freedom it measures, in the order of DEGREES_OF_FREEDOM.
    """

    sensor: str
    T_base_door: FloatArray
    covariance: FloatArray
    sees: tuple[bool, ...]
