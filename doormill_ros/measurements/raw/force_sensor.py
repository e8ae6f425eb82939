"""The force sensor of the thesis and the angle at which it is bolted to the flange."""

from __future__ import annotations

import math

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import rotate_wrench, rotation_z

#: Rotation about the flange z from sensor axes to flange axes [rad] (appendices A.8 to A.13, A.16).
MOUNTING_ROTATION = math.atan2(219.25, 226.66)


def sensor_to_flange(wrench: FloatArray, angle: float = MOUNTING_ROTATION) -> FloatArray:
    """Sensor readings, shape (..., 6) [N, N m], written in flange axes."""
    return rotate_wrench(rotation_z(angle), wrench)
