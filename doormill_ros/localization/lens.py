"""What a lens can be."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.calibration.lens_check import check_lens

SMALLEST, LARGEST = 16, 32_767  # px, what the picture filters take
MOST_DISTORTION = 10.0
FOCAL = (0.1, 50.0)  # of the picture's longer side
MOST_BLIND = 0.25  # of the picture, its corners, may lie beyond where the lens turns back


def no_lens(k: FloatArray, distortion: FloatArray, size: tuple[int, int]) -> str:
    """What makes these intrinsics those of no camera, as the end of a sentence that has named where they are from.

    Args:
        k: Camera matrix [px], shape (3, 3).
        distortion: Coefficients of Brown's model, shape (n,).
        size: Picture width and height [px].

    Returns:
        "has ..., allowed are ..." or the like; empty where a camera may have them.
    """
    if not all(SMALLEST <= side <= LARGEST for side in size):
        return f"is for {size[0]} x {size[1]} px, allowed are {SMALLEST} to {LARGEST} px"
    whole = np.isfinite(k).all() and np.array_equal(k[[1, 2, 2, 2], [0, 0, 1, 2]], [0.0, 0.0, 0.0, 1.0])
    near, far = FOCAL[0] * max(size), FOCAL[1] * max(size)
    focal, centre = k[[0, 1], [0, 1]], k[:2, 2]
    focused = whole and bool(((focal >= near) & (focal <= far)).all()) and abs(k[0, 1]) <= 0.1 * focal[0]
    if not focused or not bool(((centre >= 0) & (centre <= np.array(size))).all()):
        return (
            f"has K = {[float(f'{v:.6g}') for v in k.ravel()]}, allowed are focal lengths of {near:g} to {far:g} px "
            f"and a centre inside the picture of {size[0]} x {size[1]} px"
        )
    most = float(np.abs(distortion).max(initial=0.0))
    if not most <= MOST_DISTORTION:
        return f"has distortion coefficients up to {most:g}, allowed are {MOST_DISTORTION:g}"
    radial = np.zeros(5)
    radial[: min(5, distortion.size)] = distortion[:5]
    blind = check_lens(k, size, (radial[0], radial[1], radial[4])).blind_share
    if blind > MOST_BLIND:
        return f"has no ray for {blind:.0%} of the picture by its distortion, allowed are {MOST_BLIND:.0%}"
    return ""
