"""The camera: intrinsics, lens distortion and where the slider puts it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

import cv2
import numpy as np
from pydantic import StrictBool

from doormill_ros.arrays import FloatArray
from doormill_ros.config import check, read
from doormill_ros.frames import rotation_from_vector, transform
from doormill_ros.localization.empty_clamp.empty_clamp import EmptyClamp, EmptyClampEntry, load_empty_clamps
from doormill_ros.localization.errors import BadCameraFile
from doormill_ros.localization.lens import no_lens
from doormill_ros.localization.marks.marks import Marks
from doormill_ros.resources import resource
from doormill_ros.values import Array, Count, FiniteNumber, Section, Vector3

FORM = "config/camera.yaml"

# Columns are camera x, y, z in base axes: z into the picture is base x, x right is -y, y down is -z.
R_BASE_CAMERA_NOMINAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])

# Each round of the inversion gains more than a decimal; watching the error would double its time.
_UNDISTORT_STOP = (cv2.TERM_CRITERIA_COUNT, 6, 0.0)


def _frozen(values: object, shape: tuple[int, ...], name: str) -> FloatArray:
    array = np.array(values, dtype=float)
    if array.shape != shape or not np.all(np.isfinite(array)):
        raise BadCameraFile(
            f"camera {name} has shape {array.shape}, allowed are finite numbers of shape {shape}; correct it",
            name=name,
        )
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class CameraModel:
    """A pin-hole camera with Brown distortion on a slider.

    Attributes:
        k: Intrinsic matrix [px], shape (3, 3), thesis eq. 3.43.
        distortion: k1, k2, p1, p2, k3 of the Brown model, shape (5,).
        size: Picture width and height [px].
        position: x, y at a door width of zero, z of the projection centre in base [m], shape (3,).
        rotation_vector: Turn from the nominal viewing directions, camera axes [rad], shape (3,).
        marks: What stands still beside the door and tells whether the camera does; None in a cell without.
        empty: Pictures of the clamp without a door, by the width for which the slider stood; a cell need not have any.
    """

    k: FloatArray
    distortion: FloatArray
    size: tuple[int, int]
    position: FloatArray
    rotation_vector: FloatArray
    marks: Marks | None = None
    empty: tuple[EmptyClamp, ...] = ()

    def __post_init__(self) -> None:
        """Check and freeze the arrays.

        Raises:
            BadCameraFile: A wrong shape, a value that is not finite or a focal length that is not positive.
        """
        for name, shape in (
            ("k", (3, 3)),
            ("distortion", (5,)),
            ("position", (3,)),
            ("rotation_vector", (3,)),
        ):
            object.__setattr__(self, name, _frozen(getattr(self, name), shape, name))
        width, height = (int(v) for v in self.size)
        object.__setattr__(self, "size", (width, height))
        if self.marks is not None and self.marks.x <= self.position[0]:
            raise BadCameraFile(
                f"the marks stand at x = {self.marks.x:g} m, allowed is beyond the camera's {self.position[0]:g} m; "
                "correct marks.x"
            )
        if min(width, height) < 1 or self.k[0, 0] <= 0 or self.k[1, 1] <= 0:
            raise BadCameraFile(
                f"camera of {width} x {height} px has focal lengths {self.k[0, 0]:g} and {self.k[1, 1]:g} px, "
                "allowed are positive numbers; calibrate it again",
            )

    def with_intrinsics(self, k: FloatArray, distortion: FloatArray, size: tuple[int, int]) -> CameraModel:
        """This camera with intrinsics from elsewhere, for example those sent with a picture.

        Args:
            k: Intrinsic matrix [px], shape (3, 3).
            distortion: k1, k2, p1, p2, k3, shape (5,).
            size: Picture width and height [px].

        Raises:
            BadCameraFile: A wrong shape or a value out of bounds.
        """
        return replace(self, k=k, distortion=distortion, size=size)

    @property
    def focal(self) -> float:
        """Focal length, the geometric mean of both directions [px]."""
        return math.sqrt(self.k[0, 0] * self.k[1, 1])

    @cached_property
    def _lens(self) -> tuple[list[float], list[float]]:
        """Distortion, and focal lengths, skew and centre, as numbers: faster with arrays than NumPy's own."""
        return self.distortion.tolist(), self.k[[0, 0, 0, 1, 1], [0, 1, 2, 1, 2]].tolist()

    @cached_property
    def _R_base_camera(self) -> FloatArray:
        return R_BASE_CAMERA_NOMINAL @ rotation_from_vector(self.rotation_vector)

    def T_base_camera(self, width: float) -> FloatArray:
        """Camera frame in base for a door of `width` [m], shape (4, 4): the slider follows the hinge edge."""
        return transform(self._R_base_camera, self.position - [0.0, width / 2.0, 0.0])

    def distort(self, rays: FloatArray) -> FloatArray:
        """Pixels (..., 2) of ideal rays x/z, y/z (..., 2); Brown's model."""
        return self.distorted(*rays.reshape(-1, 2).T).T.reshape(rays.shape)

    def distorted(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Pixels u and v (2, n) of ideal rays x/z (n,), y/z (n,); see `distort`."""
        (k1, k2, p1, p2, k3), (fx, skew, cx, fy, cy) = self._lens
        r2 = x * x
        r2 += y * y
        # What radial and tangential distortion have in common, for both coordinates at once.
        # In place, for most of an expression's time goes into its temporary arrays.
        common = r2 * k3
        common += k2
        common *= r2
        common += k1
        common *= r2
        common += 1.0
        common += (2.0 * p1) * y + (2.0 * p2) * x
        pixels = np.empty((2, x.size))
        u, v = pixels
        np.multiply(y, common, out=v)
        v += p1 * r2
        np.multiply(x, common, out=u)
        u += p2 * r2
        u *= fx
        u += skew * v + cx
        v *= fy
        v += cy
        return pixels

    def undistort(self, pixels: FloatArray) -> FloatArray:
        """Ideal rays x/z, y/z (n, 2) of pixels (n, 2); inverse of `distort`."""
        pixels = np.ascontiguousarray(pixels, dtype=np.float64).reshape(-1, 1, 2)
        if hasattr(
            cv2, "undistortPointsIter"
        ):  # OpenCV 4, the newest that does with a ROS 2 installation's numpy 1
            rays = cv2.undistortPointsIter(
                pixels, self.k, self.distortion, None, None, criteria=_UNDISTORT_STOP
            )
        else:
            rays = cv2.undistortPoints(pixels, self.k, self.distortion, criteria=_UNDISTORT_STOP)
        ideal: FloatArray = rays[:, 0]
        return ideal

    def project(self, points: FloatArray, width: float) -> FloatArray:
        """Pixels (..., 2) of points in base (..., 3) [m], the slider standing at `width`."""
        T_base_camera = self.T_base_camera(width)
        seen = (np.asarray(points) - T_base_camera[:3, 3]) @ T_base_camera[:3, :3]
        return self.distort(seen[..., :2] / seen[..., 2:])


@dataclass(frozen=True, eq=False)
class _Intrinsics(Section):
    k: Annotated[FloatArray, Array((3, 3))]
    measured: StrictBool = False
    deviation: Any = None


@dataclass(frozen=True, eq=False)
class _Distortion(Section):
    coefficients: Annotated[FloatArray, Array((5,))]
    measured: StrictBool = False
    deviation: Any = None
    covered: Any = None


_Metres = Annotated[float, FiniteNumber("metres from -100 to 100", -100.0, 100.0)]


@dataclass(frozen=True, eq=False)
class _Mounting(Section):
    x: _Metres
    slider_y: _Metres
    z: _Metres
    rotation_vector: Vector3
    measured: StrictBool = False
    deviation: Any = None


@dataclass(frozen=True, eq=False)
class _CameraFile(Section):
    """What a calibration leaves in the file beside the camera is not looked at; `localizer` belongs to `settings`."""

    size: tuple[Count, Count]
    intrinsics: _Intrinsics
    distortion: _Distortion
    mounting: _Mounting
    chessboard: Any = None
    marks: Marks | None = None
    empty_clamp: tuple[EmptyClampEntry, ...] = ()
    localizer: Any = None


def load_camera(path: Path | None = None, folder: Path | None = None) -> CameraModel:
    """Read config/camera.yaml, or another file of the same form.

    Args:
        path: The file; None for config/camera.yaml.
        folder: From which the paths in it are; None for the file's own.

    Raises:
        BadCameraFile: A key is missing or unknown, a value out of bounds, or a picture of the empty clamp of no use.
    """
    path = path or resource(FORM)
    content = read(path, _CameraFile, BadCameraFile, f"compare it with {FORM}")
    return _made(content, str(path), folder or path.parent)


def camera_of(document: object, name: str, folder: Path) -> CameraModel:
    """What `load_camera` would make of a file.

    Args:
        document: The plain value of its text.
        name: What it is called in messages.
        folder: From which the paths in it are.

    Raises:
        BadCameraFile: As for `load_camera`.
    """
    return _made(check(document, _CameraFile, BadCameraFile, name, f"compare it with {FORM}"), name, folder)


def _made(content: _CameraFile, name: str, folder: Path) -> CameraModel:
    mounting = content.mounting
    reason = no_lens(content.intrinsics.k, content.distortion.coefficients, content.size)
    if reason:
        raise BadCameraFile(f"{name}: the camera {reason}; calibrate it again", path=name)
    turn = math.hypot(*mounting.rotation_vector)
    if turn > math.pi:
        raise BadCameraFile(
            f"{name}: the camera is turned by {turn:g} rad, allowed is half a turn; correct mounting.rotation_vector",
            path=name,
        )
    try:
        camera = CameraModel(
            k=content.intrinsics.k,
            distortion=content.distortion.coefficients,
            size=content.size,
            position=np.array([mounting.x, mounting.slider_y, mounting.z]),
            rotation_vector=mounting.rotation_vector,
            marks=content.marks,
        )
        if not content.empty_clamp:
            return camera
        empty = load_empty_clamps(content.empty_clamp, folder, camera.k, camera.distortion, camera.size)
        return replace(camera, empty=empty)
    except BadCameraFile as error:
        raise BadCameraFile(f"{name}: {error.message}", path=name) from error
