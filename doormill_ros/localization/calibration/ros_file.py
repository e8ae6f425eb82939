"""Intrinsics as ROS' camera_calibration writes and camera_info_manager reads them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import cv2
import numpy as np
import yaml

from doormill_ros.arrays import FloatArray
from doormill_ros.config import read
from doormill_ros.files import write_atomically
from doormill_ros.localization.calibration.errors import BadCalibrationFile
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.lens import no_lens
from doormill_ros.values import Array, Count, Finite, Section

_BROWN = {"plumb_bob": (4, 5), "rational_polynomial": (5, 8)}  # coefficients of each model


@dataclass(frozen=True, eq=False)
class _Square(Section):
    rows: Count
    cols: Count
    data: Annotated[FloatArray, Array((9,))]


@dataclass(frozen=True, eq=False)
class _Coefficients(Section):
    rows: Count
    cols: Count
    data: tuple[Finite, ...]


@dataclass(frozen=True, eq=False)
class _RosFile(Section):
    image_width: Count
    image_height: Count
    camera_matrix: _Square
    distortion_model: str
    distortion_coefficients: _Coefficients
    camera_name: str = ""
    rectification_matrix: Any = None
    projection_matrix: Any = None


@dataclass(frozen=True, eq=False)
class RosIntrinsics:
    """What such a file says of one camera.

    Attributes:
        name: Of the camera.
        size: Picture width and height [px].
        k: Camera matrix [px], shape (3, 3).
        distortion: k1, k2, p1, p2, k3, shape (5,).
    """

    name: str
    size: tuple[int, int]
    k: FloatArray
    distortion: FloatArray


def read_ros_file(path: Path) -> RosIntrinsics:
    """Read one; rectification and projection, which belong to rectified pictures, are left aside.

    Raises:
        BadCalibrationFile: A key is missing or a value of no use, the lens model is not Brown's, or the lens that
            of no camera.
    """
    advice = "write it with camera_calibration, see docs/calibration.md"
    content = read(path, _RosFile, BadCalibrationFile, advice)
    model, given = content.distortion_model, content.distortion_coefficients.data
    if len(given) not in _BROWN.get(model, ()) or any(given[5:]):
        raise BadCalibrationFile(
            f"{path} has distortion model {model!r} with {len(given)} coefficients, allowed is plumb_bob with four or "
            "five; calibrate the camera with that model",
            path=str(path),
        )
    rows, columns = content.camera_matrix.rows, content.camera_matrix.cols
    if (rows, columns) != (3, 3):
        raise BadCalibrationFile(
            f"{path} has a camera matrix of {rows} x {columns}, allowed is 3 x 3; {advice}", path=str(path)
        )
    rows, columns = content.distortion_coefficients.rows, content.distortion_coefficients.cols
    if sorted((rows, columns)) != [1, len(given)]:
        raise BadCalibrationFile(
            f"{path} has {rows} x {columns} distortion coefficients and {len(given)} numbers of them, allowed are as "
            f"many numbers in one row; {advice}",
            path=str(path),
        )
    k, size = np.array(content.camera_matrix.data).reshape(3, 3), (content.image_width, content.image_height)
    distortion = np.zeros(5)
    distortion[: min(5, len(given))] = given[:5]
    wrong = no_lens(k, distortion, size)
    if wrong:
        raise BadCalibrationFile(
            f"{path} {wrong}; calibrate the camera, see docs/calibration.md", path=str(path)
        )
    return RosIntrinsics(content.camera_name, size, k, distortion)


def write_ros_file(camera: CameraModel, name: str, path: Path) -> None:
    """Write one; its projection fills the rectified picture with pixels that were seen, as camera_calibration's does.

    Raises:
        OSError: It cannot be written.
    """
    seen, _ = cv2.getOptimalNewCameraMatrix(camera.k, camera.distortion, camera.size, 0.0)
    document = {
        "image_width": camera.size[0],
        "image_height": camera.size[1],
        "camera_name": name,
        "camera_matrix": _matrix(camera.k),
        "distortion_model": "plumb_bob",
        "distortion_coefficients": _matrix(camera.distortion[None]),
        "rectification_matrix": _matrix(np.eye(3)),
        "projection_matrix": _matrix(np.hstack([seen, np.zeros((3, 1))])),
    }
    write_atomically(path, yaml.safe_dump(document, sort_keys=False, default_flow_style=None, width=1000))


def _matrix(values: FloatArray) -> dict[str, Any]:
    rows, columns = values.shape
    return {"rows": rows, "cols": columns, "data": [float(v) for v in values.ravel()]}
