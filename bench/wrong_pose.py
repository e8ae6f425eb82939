"""What is a wrong pose of a door in a picture: one that must not be milled."""

from __future__ import annotations

import numpy as np

from doormill_ros.localization.result import Localization
from doormill_ros.simulation.picture.scene import PictureScene
from doormill_ros.units import DEG, MM

#: More than half of what the thesis reached [m], [rad], and standard deviations of its own.
WRONG_PLACE, WRONG_ANGLE, WRONG_SIGMA = 0.1 * MM, 0.1 * DEG, 5.0


def distance(found: Localization, scene: PictureScene) -> float:
    """How far from its place in the scene a door was found [m]."""
    return float(np.hypot(found.offset.y - scene.offset.y, found.offset.z - scene.offset.z))


def is_wrong(found: Localization, scene: PictureScene) -> bool:
    """Whether a door was found too far from its place, too much turned or more certainly than it was seen."""
    got, true = found.offset, scene.offset
    error = np.array([got.y - true.y, got.z - true.z, got.rotation - true.rotation])
    sigma = float(np.sqrt(error @ np.linalg.solve(found.covariance, error)))
    off = distance(found, scene) > WRONG_PLACE or abs(error[2]) > WRONG_ANGLE
    return bool(off or sigma > WRONG_SIGMA)
