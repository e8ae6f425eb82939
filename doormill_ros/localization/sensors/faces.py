"""The three faces of the door that meet in its origin, and how far a point or a beam is from them."""

from __future__ import annotations

from typing import Literal

import numpy as np

from doormill_ros.arrays import FloatArray

Face = Literal["face", "hinge", "bottom"]
# Outward normals in door axes. All three faces pass through the door's origin.
OUTWARD: dict[Face, FloatArray] = {
    "face": np.array([-1.0, 0.0, 0.0]),
    "hinge": np.array([0.0, -1.0, 0.0]),
    "bottom": np.array([0.0, 0.0, -1.0]),
}


def normals(names: tuple[Face, ...]) -> FloatArray:
    """Outward normals of the named faces in door axes, shape (n, 3)."""
    return np.array([OUTWARD[name] for name in names])


def heights(
    T_base_door: FloatArray, outward: FloatArray, points: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """How far points stand outside faces, and the derivative by a twist of the door.

    With a point p, the door's origin c and a normal n (base axes) the height is n . (p - c). A twist
    (d, w) gives -n . d + (w x n) . (p - c) = -n . d + w . (n x (p - c)).

    Args:
        T_base_door: Pose of the door, shape (4, 4).
        outward: Normals in door axes, shape (n, 3).
        points: Points in base [m], shape (n, 3).

    Returns:
        Heights, shape (n,) [m], and derivatives, shape (n, 6).
    """
    n = outward @ T_base_door[:3, :3].T
    arm = points - T_base_door[:3, 3]
    return np.sum(n * arm, axis=1), np.hstack([-n, np.cross(n, arm)])


def ranges(
    T_base_door: FloatArray, outward: FloatArray, origins: FloatArray, directions: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Length of beams until they meet faces, and the derivative by a twist of the door.

    A beam o + s u meets the face where n . (o + s u - c) = 0. A twist lifts the face at the point
    of impact by minus the derivative of its height, and the beam ends earlier by that over -n . u.

    Args:
        T_base_door: Pose of the door, shape (4, 4).
        outward: Normals in door axes, shape (n, 3).
        origins: Where the beams start, base [m], shape (n, 3).
        directions: Unit vectors of the beams, base, shape (n, 3).

    Returns:
        Lengths, shape (n,) [m], and derivatives, shape (n, 6).
    """
    n = outward @ T_base_door[:3, :3].T
    slope = np.sum(n * directions, axis=1)
    length = -np.sum(n * (origins - T_base_door[:3, 3]), axis=1) / slope
    _, derivative = heights(T_base_door, outward, origins + length[:, None] * directions)
    return length, -derivative / slope[:, None]
