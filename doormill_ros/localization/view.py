"""How the camera sees the plane of the door's face.

Points of that plane are written relative to the nominal corner: (y, z) in base axes [m].
The pose of the door in it is `(y, z, rotation)`, the three degrees of freedom that the clamp
leaves open. An edge is named "hinge" (door z axis) or "bottom" (door y axis).
"""

from __future__ import annotations

from functools import lru_cache
from math import cos, sin

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.localization.camera import CameraModel

HINGE, BOTTOM = "hinge", "bottom"
EDGES = (HINGE, BOTTOM)


def directions(rotation: float) -> tuple[FloatArray, FloatArray]:
    """Door y axis and door z axis in base (y, z), each shape (2,)."""
    c, s = cos(rotation), sin(rotation)
    return np.array((c, s)), np.array((-s, c))


class FaceView:
    """The face plane of a door of given width and thickness, seen by a camera.

    Attributes:
        camera: The camera.
        corner: Nominal corner of the face in base, shape (3,) [m].
        distance: From the camera to the face along base x [m].
        pixel: Size of a pixel on the face at the nominal corner [m]; the thesis' dynamic scale.
    """

    def __init__(self, camera: CameraModel, layout: CellLayout, width: float, thickness: float) -> None:
        """Put the nominal door before the camera; width and thickness in [m]."""
        self.camera = camera
        self._T_base_camera = camera.T_base_camera(width)
        self.corner: FloatArray = layout.T_base_door(width, thickness)[:3, 3]
        rotation = self._T_base_camera[:3, :3]
        self._corner_seen = (self.corner - self._T_base_camera[:3, 3]) @ rotation
        self._plane_seen = np.ascontiguousarray(rotation[1:3].T)
        self.distance = float(self.corner[0] - self._T_base_camera[0, 3])
        self.pixel = self.distance / camera.focal

    def pixels(self, points: FloatArray) -> FloatArray:
        """Pixels u, v (..., 2) of face points (..., 2) [m]."""
        points = np.asarray(points, dtype=float)
        return self.planes(points.reshape(-1, 2).T).T.reshape(points.shape)

    def planes(self, points: FloatArray) -> FloatArray:
        """Pixels u and v, as picture filters want them apart (2, n), of face points y and z (2, n) [m]."""
        seen = self._plane_seen.dot(points)
        seen += self._corner_seen[:, None]
        seen[:2] /= seen[2]
        return self.camera.distorted(seen[0], seen[1])

    def points(self, pixels: FloatArray) -> FloatArray:
        """Face points (n, 2) [m] of pixels u, v (n, 2)."""
        rays = self.camera.undistort(pixels)
        rotation = self._T_base_camera[:3, :3]
        ahead = rotation[:, :2] @ rays.T + rotation[:, 2:]
        reach = self.distance / ahead[0]
        points: FloatArray = reach * ahead[1:] + (self._T_base_camera[1:3, 3] - self.corner[1:])[:, None]
        return points.T

    def sight(self, point: FloatArray) -> FloatArray:
        """Base y and z per x along the ray to a face point (2,) [m], shape (2,)."""
        start = self._T_base_camera[:3, 3]
        shift: FloatArray = (self.corner[1:] + point - start[1:]) / self.distance
        return shift

    @lru_cache(maxsize=8)  # noqa: B019  views are few and live in a cache themselves
    def length(self, edge: str) -> float:
        """Length of the nominal edge inside the picture [m]."""
        along = np.arange(0.0, 0.3, 1.0e-3)
        points = np.zeros((along.size, 2))
        points[:, 1 if edge == HINGE else 0] = along
        u, v = self.pixels(points).T
        width, height = self.camera.size
        outside = np.flatnonzero((u < 0) | (v < 0) | (u > width - 1) | (v > height - 1))
        return float(along[outside[0] - 1]) if outside.size and outside[0] > 0 else 0.0

    def line(self, edge: str, pose: FloatArray, along: FloatArray) -> FloatArray:
        """Face points (n, 2) on an edge of a door at `pose` (3,), `along` (n,) [m] from its corner."""
        axis = directions(pose[2])[1 if edge == HINGE else 0]
        return pose[:2] + np.asarray(along)[:, None] * axis


@lru_cache(maxsize=32)
def face_view(camera: CameraModel, layout: CellLayout, width: float, thickness: float) -> FaceView:
    """A view, made once for each door size."""
    return FaceView(camera, layout, width, thickness)
