"""What is a wrong pose of a door in a picture: one that must not be milled."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.result import Localization
from doormill_ros.units import DEG, MM

#: More than half of what the thesis reached [m], [rad], and standard deviations of its own.
WRONG_PLACE, WRONG_ANGLE, WRONG_SIGMA = 0.1 * MM, 0.1 * DEG, 5.0


def error(found: Localization, true: DoorOffset) -> FloatArray:
    """How far from its place a door was found: y, z [m] and rotation [rad], shape (3,)."""
    got = found.offset
    return np.array([got.y - true.y, got.z - true.z, got.rotation - true.rotation])


def distance(found: Localization, true: DoorOffset) -> float:
    """How far from its place a door was found [m]."""
    return float(np.hypot(*error(found, true)[:2]))


def sigma(found: Localization, true: DoorOffset) -> float:
    """How far from its place a door was found, in standard deviations of its own."""
    off = error(found, true)
    return float(np.sqrt(off @ np.linalg.solve(found.covariance, off)))


def is_wrong(found: Localization, true: DoorOffset) -> bool:
    """Whether a door was found too far from its place, too much turned or more certainly than it was seen."""
    off = distance(found, true) > WRONG_PLACE or abs(error(found, true)[2]) > WRONG_ANGLE
    return bool(off or sigma(found, true) > WRONG_SIGMA)
