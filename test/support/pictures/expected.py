"""The picture that a noiseless sensor would give."""

from __future__ import annotations

import numpy as np

from doormill_ros.simulation.picture.picture import exposure
from doormill_ros.simulation.picture.scene import PictureScene


def expected_picture(scene: PictureScene, seed: int) -> np.ndarray:
    """What the sensor would show without noise, clipping and rounding: grey levels, float32, (rows, columns)."""
    return exposure(scene, np.random.default_rng(seed)) * np.float32(255.0)
