"""Which way each pixel of the camera looks, written in the axes of the door."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import yaml

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.resources import resource

Array = npt.NDArray[Any]
SIDE = 16  #: rays through a pixel on a border


@dataclass(frozen=True, eq=False)
class Optics:
    """The calibrated camera of config/camera.yaml.

    Attributes:
        k: Camera matrix, shape (3, 3) [px].
        distortion: k1 k2 p1 p2 k3, shape (5,).
        width: Of the picture [px].
        height: Of the picture [px].
        x: Projection centre in the base frame [m].
        slider_y: y of the centre plus half the width of the door [m].
        z: Projection centre in the base frame [m].
    """

    k: Array
    distortion: Array
    width: int
    height: int
    x: float
    slider_y: float
    z: float


@lru_cache(maxsize=1)
def optics() -> Optics:
    """The camera as config/camera.yaml has it."""
    content = yaml.safe_load(resource("config/camera.yaml").read_text())
    mounting = content["mounting"]
    width, height = content["size"]
    return Optics(
        np.array(content["intrinsics"]["k"], dtype=float),
        np.array(content["distortion"]["coefficients"], dtype=float),
        width,
        height,
        mounting["x"],
        mounting["slider_y"],
        mounting["z"],
    )


@lru_cache(maxsize=1)
def _undistorted() -> tuple[Array, Array]:
    """Slopes x/z and y/z in camera axes of the ray of each pixel, shapes (height, width)."""
    lens = optics()
    u, v = np.meshgrid(np.arange(lens.width, dtype=float), np.arange(lens.height, dtype=float))
    x_seen = (u - lens.k[0, 2]) / lens.k[0, 0]
    y_seen = (v - lens.k[1, 2]) / lens.k[1, 1]
    k1, k2, p1, p2, k3 = lens.distortion
    x, y = x_seen.copy(), y_seen.copy()
    for _ in range(15):
        r2 = x * x + y * y
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        x_new = (x_seen - 2.0 * p1 * x * y - p2 * (r2 + 2.0 * x * x)) / radial
        y = (y_seen - p1 * (r2 + 2.0 * y * y) - 2.0 * p2 * x * y) / radial
        x = x_new
    return x, y


@dataclass(frozen=True)
class Place:
    """Where the door stands before the camera.

    Attributes:
        width: Of the door [m].
        thickness: Of the door [m].
        offset: Of the door from its nominal place.
    """

    width: float
    thickness: float
    offset: DoorOffset

    @property
    def centre(self) -> Array:
        """Projection centre in the door frame, shape (3,) [m]."""
        lens = optics()
        T_base_door = load_layout().T_base_door(self.width, self.thickness, self.offset)
        centre = np.array([lens.x, lens.slider_y - self.width / 2.0, lens.z])
        found: Array = T_base_door[:3, :3].T @ (centre - T_base_door[:3, 3])
        return found

    @property
    def distance(self) -> float:
        """From the projection centre to the plane of the face [m]."""
        return -float(self.centre[0])

    @property
    def pixel(self) -> float:
        """Width of a pixel on the face [m]."""
        return self.distance / float(optics().k[0, 0])


@dataclass(frozen=True, eq=False)
class Rays:
    """Rays from one centre in the door frame: centre + s (1, a, b), s the distance along x.

    Attributes:
        centre: Shape (3,) [m].
        a: Slopes along door y, shape (n,).
        b: Slopes along door z, shape (n,).
    """

    centre: Array
    a: Array
    b: Array

    def at(self, x: float | Array) -> tuple[Array, Array]:
        """y and z where the rays meet the plane of this x, shapes (n,) [m]."""
        s = np.float32(1.0) * (x - self.centre[0])
        return np.float32(self.centre[1]) + s * self.a, np.float32(self.centre[2]) + s * self.b


def slopes(place: Place) -> tuple[Array, Array]:
    """Slopes a and b in the door frame of the ray of each pixel, float32 shapes (height, width)."""
    x, y = _undistorted()
    c, s = math.cos(place.offset.rotation), math.sin(place.offset.rotation)
    # Camera x is base -y and camera y is base -z; the door is turned about base x.
    return (-c * x - s * y).astype(np.float32), (s * x - c * y).astype(np.float32)


def within(grid: tuple[Array, Array], rows: Array, columns: Array) -> tuple[Array, Array]:
    """Slopes of SIDE rays spread over each of n pixels, shapes (n, SIDE); no two share a row or a column."""
    steps = np.arange(SIDE)
    du = ((steps + 0.5) / SIDE - 0.5).astype(np.float32)
    dv = (((steps * 7) % SIDE + 0.5) / SIDE - 0.5).astype(np.float32)
    below = np.minimum(rows, grid[0].shape[0] - 2)
    right = np.minimum(columns, grid[0].shape[1] - 2)
    found = []
    for slope in grid:
        here = slope[rows, columns]
        per_v = slope[below + 1, right] - slope[below, right]
        per_u = slope[below, right + 1] - slope[below, right]
        found.append(here[:, None] + per_u[:, None] * du + per_v[:, None] * dv)
    return found[0], found[1]


def pixels_of(place: Place, points: Array) -> Array:
    """Where points of the door frame, shape (n, 3) [m], are seen, shape (n, 2) [px]."""
    lens = optics()
    c, s = math.cos(place.offset.rotation), math.sin(place.offset.rotation)
    p = np.asarray(points, dtype=float) - place.centre
    y, z = c * p[:, 1] - s * p[:, 2], s * p[:, 1] + c * p[:, 2]
    in_camera = np.stack([-y, -z, p[:, 0]], axis=1)
    seen, _ = cv2.projectPoints(in_camera, np.zeros(3), np.zeros(3), lens.k, lens.distortion)
    found: Array = seen.reshape(-1, 2)
    return found
