"""The camera of a picture, from the camera info that came with it; few nodes need OpenCV, so it stands by itself."""

from __future__ import annotations

from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.errors import BadCameraInfo
from doormill_ros.messages.picture import LARGEST, SMALLEST
from doormill_ros.messages.sensor_window import in_window

#: Names of the lens model with k1, k2, p1, p2, k3; the second one has more, which have to be zero.
BROWN = ("plumb_bob", "rational_polynomial")
MOST_DISTORTION = 10.0
FOCAL = (0.1, 50.0)  # of the picture's longer side


def camera_of(message: Any, mounted: CameraModel) -> CameraModel:
    """The mounted camera with the intrinsics of a sensor_msgs/CameraInfo, as the pictures with it have them.

    Raises:
        BadCameraInfo: No calibration, one of another lens model than Brown's, or one that no camera has; a part of the
            sensor that it has not.
    """
    _require_size(message)
    k = np.array(message.k, dtype=float).reshape(3, 3)
    _require_matrix(k, message)
    distortion = np.zeros(5)
    distortion[: min(5, len(message.d))] = message.d[:5]
    model, beyond = message.distortion_model, np.asarray(message.d[5:], dtype=float)
    lensless = model == "" and not np.any(message.d)
    if (model not in BROWN and not lensless) or beyond.any():
        raise BadCameraInfo(
            f"the camera info has distortion model {model!r} with {len(message.d)} coefficients, allowed is "
            f"{BROWN[0]} with five; calibrate the camera with that model"
        )
    if not np.abs(distortion).max() <= MOST_DISTORTION:
        raise BadCameraInfo(
            f"the camera info has distortion coefficients up to {np.abs(distortion).max():g}, allowed are "
            f"{MOST_DISTORTION:g}; calibrate the camera again"
        )
    k, size = in_window(k, message)
    return mounted.with_intrinsics(k, distortion, size)


def _require_size(message: Any) -> None:
    sizes = (int(message.width), int(message.height))
    if not all(SMALLEST <= size <= LARGEST for size in sizes):
        raise BadCameraInfo(
            f"the camera info is for {sizes[0]} x {sizes[1]} px, allowed are {SMALLEST} to {LARGEST} px; check the "
            "camera's driver",
            size=sizes,
        )


def _require_matrix(k: FloatArray, message: Any) -> None:
    if not k.any():
        raise BadCameraInfo(
            "the camera info holds no calibration: K is zero; calibrate the camera and let its driver send that"
        )
    size = np.array([message.width, message.height], dtype=float)
    focal, centre = np.array([k[0, 0], k[1, 1]]), k[:2, 2]
    whole = np.isfinite(k).all() and np.array_equal(k[[1, 2, 2, 2], [0, 0, 1, 2]], [0.0, 0.0, 0.0, 1.0])
    near, far = FOCAL[0] * size.max(), FOCAL[1] * size.max()
    focused = whole and bool(((focal >= near) & (focal <= far)).all()) and abs(k[0, 1]) <= 0.1 * focal[0]
    if not focused or not bool(((centre >= 0) & (centre <= size)).all()):
        raise BadCameraInfo(
            f"the camera info has K = {[float(f'{v:.6g}') for v in k.ravel()]}, allowed are focal lengths of "
            f"{near:g} to {far:g} px and a centre inside the picture; calibrate the camera again"
        )
