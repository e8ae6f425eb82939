"""Where the cell's marks stand, seen by the camera that they are to check: calibrated well a moment before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization.calibration.errors import BadCalibrationFile, TooFewPictures
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.checks import check_size
from doormill_ros.localization.marks.mark_finder import find_marks

_FINEST = 2e-6  # m; what uneven light leaves in all pictures alike


@dataclass(frozen=True, eq=False)
class MarkPlaces:
    """What pictures tell of the marks.

    Attributes:
        places: y at a door width of zero and z of each [m], shape (n, 2).
        moved: How far they are from where the file had them [m], shape (n,).
        deviation: Standard deviation of a place [m].
    """

    places: FloatArray
    moved: FloatArray
    deviation: float


def measure_marks(pictures: Sequence[ByteArray], camera: CameraModel) -> MarkPlaces:
    """Put the marks of a camera file where pictures show them, wherever the slider stood: they go with it.

    Args:
        pictures: Grey pictures, shape (h, w), uint8; best without a door.
        camera: The calibrated camera with marks within one and a half radii of their places.

    Raises:
        BadCalibrationFile: The file has no marks.
        CameraInfoSize: A picture has another size than the camera.
        TooFewPictures: A mark is seen in fewer than two pictures.
    """
    if camera.marks is None:
        raise BadCalibrationFile(
            "the camera file has no marks; add the section of docs/calibration.md with places measured to 2 mm"
        )
    for picture in pictures:
        check_size(picture.shape[::-1], camera)
    centres = camera.marks.centres(0.0)
    expected = camera.project(centres, 0.0)
    rims = camera.project(centres + np.array([0.0, camera.marks.radius, 0.0]), 0.0)
    radii = np.linalg.norm(rims - expected, axis=1)
    seen = np.stack([find_marks(picture, expected, radii) for picture in pictures])
    count = np.isfinite(seen[..., 0]).sum(axis=0)
    if np.any(count < 2):
        rare = int(np.argmin(count))
        raise TooFewPictures(
            f"mark {rare + 1} of {len(centres)} is seen in {count[rare]} of {len(pictures)} pictures, 2 are needed; "
            "take pictures without a door, correct its place to 2 mm, or remove it from the file"
        )
    T_base_camera = camera.T_base_camera(0.0)
    rays = np.full((*seen.shape[:2], 3), np.nan)
    there = np.isfinite(seen[..., 0])
    rays[there] = (
        np.column_stack([camera.undistort(seen[there]), np.ones(there.sum())]) @ T_base_camera[:3, :3].T
    )
    start = T_base_camera[:3, 3]
    points = start[1:] + (camera.marks.x - start[0]) / rays[..., :1] * rays[..., 1:]
    places = np.nanmean(points, axis=0)
    spread = np.nanstd(points, axis=0, ddof=1) / np.sqrt(count)[:, None]
    return MarkPlaces(
        places,
        np.linalg.norm(places - centres[:, 1:], axis=1),
        float(np.hypot(_FINEST, np.sqrt(np.mean(spread**2)))),
    )
