"""How far two lenses are apart in the picture."""

from __future__ import annotations

import numpy as np

from doormill_ros.localization.camera import CameraModel

#: Largest distance [px] at which two lenses are one. A mounting belongs to the lens that it was calibrated with, so a
#: lens calibrated anew is another one; what may differ is rounding: to the five decimals of camera_calibration 0.04 px.
#: On a door it is 0.01 mm, less than a calibration of the mounting leaves.
SAME = 0.1
_NODES = 25  # grid points along each side of the picture


def lens_apart(sent: CameraModel, mounted: CameraModel) -> float:
    """Largest distance [px] between where two lenses of one picture size show the same ray, inside the picture.

    Infinite where one of them shows it nowhere.
    """
    if np.array_equal(sent.k, mounted.k) and np.array_equal(sent.distortion, mounted.distortion):
        return 0.0
    u, v = (np.linspace(0.0, side - 1.0, _NODES) for side in mounted.size)
    rays = mounted.undistort(np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2))
    with np.errstate(all="ignore"):  # a lens far off may show a ray anywhere
        apart = float(np.linalg.norm(sent.distort(rays) - mounted.distort(rays), axis=1).max())
    return apart if np.isfinite(apart) else np.inf
