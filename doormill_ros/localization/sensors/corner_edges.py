"""The two edges of the door that leave its corner, found in one picture."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.frames import apply_twist
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.sensors.edge_rays import EDGES, seen
from doormill_ros.localization.sensors.edge_search import find_edge
from doormill_ros.localization.sensors.errors import EdgeNotFound
from doormill_ros.recipes.door import DoorSize
from doormill_ros.values import NotNegative, Section

# The two door axes whose edges bound each face, and so are seen by a camera that looks at it.
BOUNDS = {"face": ("y", "z"), "bottom": ("x", "y"), "hinge": ("x", "z")}
_SPACING = 2.0e-3  # of scan lines along an edge [m]
_MARGIN = 14.0  # px from the picture's rim
_LONGEST = 0.25  # m; no picture shows more of an edge
_FEWEST = 6


@dataclass(frozen=True)
class PictureQuality(Section):
    """Standard deviation of a grey value and the smallest step across an edge [grey levels]."""

    noise: NotNegative
    min_contrast: NotNegative


@dataclass(frozen=True, eq=False)
class EdgeRays:
    """What a picture tells about one edge.

    Attributes:
        axis: Which door axis the edge is, 0 to 2.
        rays: Ideal rays x/z, y/z, shape (n, 2).
        along: Their places along the edge from the corner [m], shape (n,).
        deviation: Standard deviation across the edge from the picture's noise [px].
    """

    axis: int
    rays: FloatArray
    along: FloatArray
    deviation: float


def find_corner_edges(
    picture: ByteArray,
    lens: CameraModel,
    T_base_camera: FloatArray,
    T_base_door: FloatArray,
    face: str,
    door: DoorSize,
    limits: FloatArray,
    quality: PictureQuality,
    what: str,
) -> list[EdgeRays]:
    """Find both edges that bound a face at the door's corner.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        lens: Intrinsics.
        T_base_camera: Where the camera stands, shape (4, 4).
        T_base_door: Guess of the door's pose, shape (4, 4).
        face: The face, a key of BOUNDS.
        door: Size of the door.
        limits: How far the guess may be off, shape (6,) [m, rad].
        quality: Noise and least contrast.
        what: Name of the picture, for messages.

    Raises:
        EdgeNotFound: An edge does not show.
    """
    extent = {"x": door.thickness, "y": door.width, "z": door.height}
    out = []
    for edge, other in zip(BOUNDS[face], BOUNDS[face][::-1], strict=True):
        name, axis = f"the {edge} edge in {what}", EDGES[edge]
        # Near its ends an edge that stands off may already be over.
        spare = limits[axis] + _SPACING
        along = np.arange(spare, min(extent[edge] - spare, _LONGEST), _SPACING)
        guess = lens.distort(seen(T_base_door, T_base_camera, axis, along))
        inward = _inward(lens, T_base_camera, T_base_door, axis, EDGES[other], along, guess)
        reach = 2.0
        for signs in itertools.product((-1.0, 1.0), repeat=6):
            moved = apply_twist(T_base_door, np.array(signs) * limits)
            shift = lens.distort(seen(moved, T_base_camera, axis, along)) - guess
            reach = max(reach, 2.0 + float(np.abs(np.sum(shift * inward, axis=1)).max(initial=0.0)))
        # Scan lines may leave the picture on one side; an edge that is found lies where they do not.
        size = np.array(lens.size) - 1.0
        shows = np.all((guess > _MARGIN) & (guess < size - _MARGIN), axis=1)
        along, guess, inward = along[shows], guess[shows], inward[shows]
        if along.size < _FEWEST:
            raise EdgeNotFound(f"{name} does not show long enough; correct the camera's place", edge=name)
        points = find_edge(picture, guess, inward, reach, quality.noise, quality.min_contrast, name)
        out.append(EdgeRays(axis, lens.undistort(points.pixels), along[points.index], points.deviation))
    return out


def _inward(
    lens: CameraModel,
    T_base_camera: FloatArray,
    T_base_door: FloatArray,
    axis: int,
    other: int,
    along: FloatArray,
    guess: FloatArray,
) -> FloatArray:
    """Unit vectors across the edge in the picture, towards where the other edge runs; shape (n, 2)."""
    ahead = lens.distort(seen(T_base_door, T_base_camera, axis, along + 1e-4)) - guess
    across = np.column_stack([-ahead[:, 1], ahead[:, 0]]) / np.linalg.norm(ahead, axis=1, keepdims=True)
    corner, inside = lens.distort(seen(T_base_door, T_base_camera, other, np.array([0.0, 1e-3])))
    inward: FloatArray = across * np.sign(across @ (inside - corner))[:, None]
    return inward
