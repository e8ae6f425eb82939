"""Edges of the door against the rays on which a camera sees them.

The three edges that meet in the door's origin are its axes. An edge through c along a and the
projection centre o span a plane with normal m = a x (c - o); in camera axes l = R^T m is the
edge's line in the picture, and a ray p = (x, y, 1) misses it by r = l . p / |(l_1, l_2)|, a
distance in the picture at unit focal length.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import inverse

EDGES = {"x": 0, "y": 1, "z": 2}


def cross_matrix(v: FloatArray) -> FloatArray:
    """[v] with [v] w = v x w, shape (3, 3)."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def miss(
    T_base_door: FloatArray, T_base_camera: FloatArray, axis: int, rays: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """How far rays pass an edge, and the derivatives by twists of door and camera.

    Args:
        T_base_door: Pose of the door, shape (4, 4).
        T_base_camera: Pose of the camera, shape (4, 4).
        axis: Which door axis the edge is, 0 to 2.
        rays: Ideal rays x/z, y/z, shape (n, 2).

    Returns:
        Miss, shape (n,) [unit focal length], its derivative by a twist of the door at the door's
        origin, shape (n, 6), and by a twist of the camera at the projection centre, shape (n, 6);
        both twists in base axes as `frames.apply_twist` takes them.
    """
    R_base_camera = T_base_camera[:3, :3]
    a, reach = T_base_door[:3, axis], T_base_door[:3, 3] - T_base_camera[:3, 3]
    m = np.cross(a, reach)
    line = R_base_camera.T @ m
    # Twist of the door (d, w): a turns by w x a, c moves by d. Of the camera: o moves by d, R turns.
    turn_a = -cross_matrix(a)  # w x a = -[a] w
    by_door = np.hstack([cross_matrix(a), -cross_matrix(reach) @ turn_a])  # da x reach = -[reach] da
    by_camera = np.hstack([-cross_matrix(a), cross_matrix(m)])  # R^T turns m by -w x m = [m] w
    size = np.hypot(line[0], line[1])
    points = np.column_stack([rays, np.ones(len(rays))])
    value = points @ line / size

    def derivative(dm: FloatArray) -> FloatArray:
        dline = R_base_camera.T @ dm  # (3, 6)
        dsize = (line[0] * dline[0] + line[1] * dline[1]) / size
        by_twist: FloatArray = (points @ dline - np.outer(value, dsize)) / size
        return by_twist

    return value, derivative(by_door), derivative(by_camera)


def depth(T_base_door: FloatArray, T_base_camera: FloatArray, axis: int, along: FloatArray) -> FloatArray:
    """Distance ahead of the camera of edge points `along` (n,) [m] from the corner, shape (n,) [m]."""
    T_camera_door = inverse(T_base_camera) @ T_base_door
    ahead: FloatArray = T_camera_door[2, 3] + np.asarray(along) * T_camera_door[2, axis]
    return ahead


def seen(T_base_door: FloatArray, T_base_camera: FloatArray, axis: int, along: FloatArray) -> FloatArray:
    """Ideal rays (n, 2) of edge points `along` (n,) [m] from the corner."""
    T_camera_door = inverse(T_base_camera) @ T_base_door
    points = T_camera_door[:3, 3] + np.asarray(along)[:, None] * T_camera_door[:3, axis]
    return points[:, :2] / points[:, 2:]
