"""What a lens that is not quite as its file has it does to the rays on which edges are seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.sensors.corner_edges import EdgeRays
from doormill_ros.localization.sensors.edge_rays import miss, seen
from doormill_ros.recipes.door import DoorSize

_STEPS = np.array([0.5, 0.5, 0.5, 0.5, 1e-3, 1e-3, 1e-4, 1e-4, 1e-3])  # px and coefficients


def by_lens(
    camera: CameraModel, T_base_door: FloatArray, T_base_camera: FloatArray, axis: int, rays: FloatArray
) -> FloatArray:
    """Derivative of how far rays (n, 2) pass a door's edge by fx, fy, cx, cy, k1, k2, p1, p2, k3, shape (n, 9)."""
    pixels = camera.distort(rays)
    columns = []
    for i, step in enumerate(_STEPS):
        ends = []
        for sign in (1.0, -1.0):
            k, distortion = camera.k.copy(), camera.distortion.copy()
            if i < 4:
                k[(0, 1, 0, 1)[i], (0, 1, 2, 2)[i]] += sign * step
            else:
                distortion[i - 4] += sign * step
            turned = replace(camera, k=k, distortion=distortion).undistort(pixels)
            ends.append(miss(T_base_door, T_base_camera, axis, turned)[0])
        columns.append((ends[0] - ends[1]) / (2.0 * step))
    return np.column_stack(columns)


def door_deviation(
    edges: list[EdgeRays],
    door: DoorSize,
    camera: CameraModel,
    layout: CellLayout,
    own: FloatArray,
    by_one: FloatArray,
    lens: FloatArray,
) -> FloatArray:
    """What is left in y, z and rotation of a nominal door, shape (3,).

    A lens that is off moves the door by itself and by the mounting that was found with it; in doors as thick as those
    of the calibration both cancel.

    Args:
        edges: Which part of the edges is seen.
        door: Its size.
        camera: As found.
        layout: Where it stands.
        own: Covariance of the mounting for a lens that is known, shape (6, 6).
        by_one: Derivative of the mounting by the lens, shape (6, 9).
        lens: Covariance of the lens, shape (9, 9).
    """
    T_base_door = layout.T_base_door(door.width, door.thickness)
    T_base_camera = camera.T_base_camera(door.width)
    parts = []
    for e in edges:
        rays = seen(T_base_door, T_base_camera, e.axis, e.along)
        _, by_door, by_camera = miss(T_base_door, T_base_camera, e.axis, rays)
        parts.append((by_door, by_camera, by_lens(camera, T_base_door, T_base_camera, e.axis, rays)))
    by_door, by_camera, share = (np.vstack([p[i] for p in parts]) for i in range(3))
    solved = -np.linalg.lstsq(by_door[:, 1:4], np.hstack([by_camera, share]), rcond=None)[0]
    moves, bends = solved[:, :6], solved[:, 6:]
    bends = bends + moves @ by_one
    deviation: FloatArray = np.sqrt(np.diag(moves @ own @ moves.T + bends @ lens @ bends.T))
    return deviation
