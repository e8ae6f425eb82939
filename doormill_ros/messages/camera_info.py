"""The camera of a picture, from the camera info that came with it; few nodes need OpenCV, so it stands by itself."""

from __future__ import annotations

from typing import Any

import numpy as np

from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.errors import BadCameraInfo
from doormill_ros.localization.lens import no_lens
from doormill_ros.localization.lens_apart import SAME, lens_apart
from doormill_ros.messages.sensor_window import in_window

#: Names of the lens model with k1, k2, p1, p2, k3; the second one has more, which have to be zero.
BROWN = ("plumb_bob", "rational_polynomial")


def camera_of(message: Any, mounted: CameraModel) -> CameraModel:
    """The mounted camera with the intrinsics of a sensor_msgs/CameraInfo, as the pictures with it have them.

    Raises:
        BadCameraInfo: No calibration, one of another lens model than Brown's, or one that no camera has; another lens
            than the one that the mounting was calibrated with; a part of the sensor that it has not.
    """
    size = (int(message.width), int(message.height))
    k = np.array(message.k, dtype=float).reshape(3, 3)
    if all(size) and not k.any():
        raise BadCameraInfo(
            "the camera info holds no calibration: K is zero; calibrate the camera and let its driver send that"
        )
    distortion = np.zeros(5)
    distortion[: min(5, len(message.d))] = message.d[:5]
    model, beyond = message.distortion_model, np.asarray(message.d[5:], dtype=float)
    lensless = model == "" and not np.any(message.d)
    if (model not in BROWN and not lensless) or beyond.any():
        raise BadCameraInfo(
            f"the camera info has distortion model {model!r} with {len(message.d)} coefficients, allowed is "
            f"{BROWN[0]} with five; calibrate the camera with that model"
        )
    wrong = no_lens(k, distortion, size)
    if wrong:
        raise BadCameraInfo(
            f"the camera info {wrong}; check the camera's driver, or calibrate the camera again", size=size
        )
    whole = mounted.with_intrinsics(k, distortion, size)
    k, sent = in_window(k, message)
    camera = mounted.with_intrinsics(k, distortion, sent)
    # Calibrated by pictures of the same part of the sensor, the file has what is sent and not the whole.
    _require_same(camera if sent == mounted.size else whole, mounted)
    return camera


def _require_same(sent: CameraModel, mounted: CameraModel) -> None:
    apart = lens_apart(sent, mounted) if sent.size == mounted.size else np.inf
    if not apart <= SAME:
        by = f", up to {apart:.3g} px apart" if np.isfinite(apart) else ""
        raise BadCameraInfo(
            f"the camera info is of a lens with {_told(sent)}, the cell's calibration is of one with "
            f"{_told(mounted)}{by}, allowed are {SAME:g} px; let the camera's driver send the cell's calibration "
            "(calibrate export), or take the lens into it (calibrate import) and calibrate the mounting again "
            "(calibrate extrinsics)",
            apart=apart,
        )


def _told(camera: CameraModel) -> str:
    (fx, fy), (cx, cy) = camera.k[[0, 1], [0, 1]], camera.k[:2, 2]
    distortion = ", ".join(f"{v:.4g}" for v in camera.distortion)
    return (
        f"{camera.size[0]} x {camera.size[1]} px, focal lengths {fx:.2f} and {fy:.2f} px, centre ({cx:.2f}, {cy:.2f}) "
        f"px and distortion {distortion}"
    )
