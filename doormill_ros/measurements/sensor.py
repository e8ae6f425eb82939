"""The force sensor of the thesis and the angle at which it is bolted to the flange."""

from __future__ import annotations

import math

import numpy as np

from doormill_ros.arrays import FloatArray

#: Rotation about the flange z from sensor axes to flange axes [rad] (appendices A.8 to A.13, A.16).
MOUNTING_ROTATION = math.atan2(219.25, 226.66)


def rotation_about_z(angle: float) -> FloatArray:
    """R_flange_sensor, shape (3, 3), for a mounting angle [rad]."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rotate_wrench(wrench: FloatArray, rotation: FloatArray) -> FloatArray:
    """Write a wrench in other axes; the point it acts at stays.

    Args:
        wrench: Force and moment in axes b, shape (..., 6) [N, N m].
        rotation: R_a_b, shape (3, 3) or (..., 3, 3).

    Returns:
        The wrench in axes a, shape (..., 6).
    """
    parts = np.asarray(wrench, dtype=float).reshape(*np.shape(wrench)[:-1], 2, 3)
    rotated = np.einsum("...ij,...kj->...ki", rotation, parts)
    return rotated.reshape(*rotated.shape[:-2], 6)


def shift_wrench(wrench: FloatArray, lever: FloatArray) -> FloatArray:
    """The same load seen at another point: m_new = m + lever x f.

    Args:
        wrench: Wrench at the old point, shape (..., 6) [N, N m].
        lever: Old point minus new point, same axes, shape (..., 3) [m].

    Returns:
        The wrench at the new point, shape (..., 6).
    """
    shifted = np.array(wrench, dtype=float)
    shifted[..., 3:] += np.cross(lever, shifted[..., :3])
    return shifted


def sensor_to_flange(wrench: FloatArray, angle: float = MOUNTING_ROTATION) -> FloatArray:
    """Sensor readings, shape (..., 6) [N, N m], written in flange axes."""
    return rotate_wrench(wrench, rotation_about_z(angle))
