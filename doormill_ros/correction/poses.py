"""Small displacements of many poses at once."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray


def rotation_from_vector(rotvec: FloatArray) -> FloatArray:
    """Rotation matrices of rotation vectors (Rodrigues' formula).

    Args:
        rotvec: Rotation vectors, shape (n, 3) [rad].

    Returns:
        Shape (n, 3, 3).
    """
    angle = np.linalg.norm(rotvec, axis=-1)  # (n,)
    # sinc keeps the formula exact down to no rotation at all.
    first = np.sinc(angle / np.pi)[:, None, None]
    second = 0.5 * np.sinc(angle / (2.0 * np.pi))[:, None, None] ** 2
    x, y, z = rotvec[:, 0], rotvec[:, 1], rotvec[:, 2]
    cross = np.zeros((*rotvec.shape, 3))  # (n, 3, 3)
    cross[:, 0, 1], cross[:, 0, 2] = -z, y
    cross[:, 1, 0], cross[:, 1, 2] = z, -x
    cross[:, 2, 0], cross[:, 2, 1] = -y, x
    return np.eye(3) + first * cross + second * (cross @ cross)


def vector_from_rotation(R_a_b: FloatArray) -> FloatArray:
    """Rotation vectors of rotations by less than half a turn.

    Args:
        R_a_b: Rotation matrices, shape (n, 3, 3).

    Returns:
        Shape (n, 3) [rad].
    """
    skew = 0.5 * np.stack(
        [
            R_a_b[:, 2, 1] - R_a_b[:, 1, 2],
            R_a_b[:, 0, 2] - R_a_b[:, 2, 0],
            R_a_b[:, 1, 0] - R_a_b[:, 0, 1],
        ],
        axis=-1,
    )  # (n, 3), length sin(angle)
    sine = np.linalg.norm(skew, axis=-1)
    cosine = 0.5 * (np.trace(R_a_b, axis1=-2, axis2=-1) - 1.0)
    angle = np.arctan2(sine, cosine)
    scale = np.ones_like(angle)
    np.divide(angle, sine, out=scale, where=sine > 1e-12)
    return skew * scale[:, None]


def displace(T_a_b: FloatArray, twist: FloatArray) -> FloatArray:
    """Move frames b by twists in the axes of a, taken at the origin of b.

    Args:
        T_a_b: Poses, shape (n, 4, 4).
        twist: Translation [m] and rotation vector [rad], shape (n, 6).

    Returns:
        The displaced poses, shape (n, 4, 4).
    """
    moved = T_a_b.copy()
    moved[:, :3, :3] = rotation_from_vector(twist[:, 3:]) @ T_a_b[:, :3, :3]
    moved[:, :3, 3] += twist[:, :3]
    return moved


def undisplace(T_a_b: FloatArray, twist: FloatArray) -> FloatArray:
    """Poses that `displace` with the same twists moves onto `T_a_b`; shapes as there."""
    moved = T_a_b.copy()
    moved[:, :3, :3] = np.swapaxes(rotation_from_vector(twist[:, 3:]), -1, -2) @ T_a_b[:, :3, :3]
    moved[:, :3, 3] -= twist[:, :3]
    return moved


def twist_to(T_a_b: FloatArray, T_a_c: FloatArray) -> FloatArray:
    """Twists, shape (n, 6) [m, rad], with which `displace` moves `T_a_b` onto `T_a_c`."""
    turned = T_a_c[:, :3, :3] @ np.swapaxes(T_a_b[:, :3, :3], -1, -2)
    return np.concatenate([T_a_c[:, :3, 3] - T_a_b[:, :3, 3], vector_from_rotation(turned)], axis=-1)
