"""Rigid transforms and the one rule by which they are named.

`T_a_b` is a (4, 4) homogeneous matrix that maps coordinates in frame b into coordinates in
frame a: `p_a = T_a_b @ p_b`, `T_a_c = T_a_b @ T_b_c`. It is also the pose of frame b seen
from frame a. `R_a_b` is its rotation, `p_a_b` its translation.

Frames: `base` (robot base, ROS name base_link), `flange`, `tool` (tool centre point, z along
the spindle axis), `door`, `camera` (ROS name camera_optical_frame).

Twists and wrenches are (6,) arrays, translation or force first. A wrench acts at a stated
point and is written in the axes of a stated frame.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray

BASE_FRAME = "base_link"
DOOR_FRAME = "door"
CAMERA_FRAME = "camera_optical_frame"
TOOL_FRAME = "tool"
#: Names of the six numbers of a wrench.
WRENCH_COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")


def rotations() -> Any:
    """SciPy's class of rotations, imported here: it takes a fifth of the start of a node that turns nothing."""
    from scipy.spatial.transform import Rotation

    return Rotation


def check_transform(T_a_b: FloatArray, name: str = "transform", tolerance: float = 1e-6) -> FloatArray:
    """Return a copied, read-only (4, 4) float64 matrix, or say what is wrong with it.

    Args:
        T_a_b: Array-like, shape (4, 4).
        name: What the matrix is, for the message.
        tolerance: Largest allowed deviation of R R^T from the identity.

    Raises:
        ValueError: Wrong shape, not finite, not a rotation, or a wrong last row.
    """
    matrix = np.array(T_a_b, dtype=float)
    if matrix.shape != (4, 4):
        raise ValueError(f"{name} has shape {matrix.shape}, allowed is (4, 4)")
    if not np.all(np.isfinite(matrix)):
        raise ValueError(f"{name} holds values that are not finite")
    rotation = matrix[:3, :3]
    error = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
    if error > tolerance or np.linalg.det(rotation) < 0:
        raise ValueError(f"{name} is not a rotation: R R^T is off by {error:.2e}, allowed {tolerance:.0e}")
    if not np.array_equal(matrix[3], [0.0, 0.0, 0.0, 1.0]):
        raise ValueError(f"{name} has last row {matrix[3].tolist()}, allowed is [0, 0, 0, 1]")
    matrix.setflags(write=False)
    return matrix


def are_transforms(T_a_b: Sequence[FloatArray], tolerance: float = 1e-6) -> bool:
    """True when `check_transform` would let each of many matrices, shape (n, 4, 4), pass."""
    try:
        matrices = np.array(T_a_b, dtype=float)
    except ValueError:
        return False
    if matrices.ndim != 3 or matrices.shape[1:] != (4, 4) or not np.all(np.isfinite(matrices)):
        return False
    rotations = matrices[:, :3, :3]
    error = np.abs(rotations @ np.swapaxes(rotations, 1, 2) - np.eye(3))
    last_rows = np.all(matrices[:, 3] == [0.0, 0.0, 0.0, 1.0])
    return bool(last_rows and np.all(error <= tolerance) and np.all(np.linalg.det(rotations) > 0.0))


def transform(rotation: FloatArray | None = None, translation: FloatArray | None = None) -> FloatArray:
    """Build T_a_b, shape (4, 4), from R_a_b, shape (3, 3), and p_a_b, shape (3,) [m]."""
    T_a_b = np.eye(4)
    if rotation is not None:
        T_a_b[:3, :3] = rotation
    if translation is not None:
        T_a_b[:3, 3] = translation
    return T_a_b


def inverse(T_a_b: FloatArray) -> FloatArray:
    """T_b_a of T_a_b; shapes (..., 4, 4)."""
    T_a_b = np.asarray(T_a_b, dtype=float)
    R_b_a = np.swapaxes(T_a_b[..., :3, :3], -1, -2)
    T_b_a = np.zeros_like(T_a_b)
    T_b_a[..., :3, :3] = R_b_a
    T_b_a[..., :3, 3] = -(R_b_a @ T_a_b[..., :3, 3:4])[..., 0]
    T_b_a[..., 3, 3] = 1.0
    return T_b_a


def apply(T_a_b: FloatArray, p_b: FloatArray) -> FloatArray:
    """Map points p_b, shape (..., 3) [m], into frame a."""
    return np.asarray(p_b) @ T_a_b[:3, :3].T + T_a_b[:3, 3]


def quaternion_xyzw(T_a_b: FloatArray) -> FloatArray:
    """Unit quaternion (x, y, z, w) of R_a_b with w >= 0; shape (..., 4). ROS order."""
    quaternion: FloatArray = rotations().from_matrix(np.asarray(T_a_b)[..., :3, :3]).as_quat(canonical=True)
    return quaternion


def quaternion_wxyz(T_a_b: FloatArray) -> FloatArray:
    """Unit quaternion (w, x, y, z) of R_a_b with w >= 0; shape (..., 4). RAPID order."""
    return quaternion_xyzw(T_a_b)[..., [3, 0, 1, 2]]


def from_xyzw(position: FloatArray, quaternion: FloatArray) -> FloatArray:
    """T_a_b from position and orientation.

    Args:
        position: p_a_b, shape (..., 3) [m].
        quaternion: (x, y, z, w) of any positive norm, shape (..., 4).
    """
    rotation = rotations().from_quat(quaternion).as_matrix()
    T_a_b = np.zeros((*rotation.shape[:-2], 4, 4))
    T_a_b[..., :3, :3] = rotation
    T_a_b[..., :3, 3] = position
    T_a_b[..., 3, 3] = 1.0
    return T_a_b


def from_wxyz(position: FloatArray, quaternion: FloatArray) -> FloatArray:
    """As `from_xyzw` from a quaternion (w, x, y, z)."""
    return from_xyzw(position, np.asarray(quaternion)[..., [1, 2, 3, 0]])


def rotation_x(angle: float) -> FloatArray:
    """R_a_b for a turn of b by `angle` [rad] about the x axis of a; shape (3, 3)."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def rotation_y(angle: float) -> FloatArray:
    """R_a_b for a turn of b by `angle` [rad] about the y axis of a; shape (3, 3)."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def rotation_z(angle: float) -> FloatArray:
    """R_a_b for a turn of b by `angle` [rad] about the z axis of a; shape (3, 3)."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rotation_rpy(angles: Sequence[float] | FloatArray) -> FloatArray:
    """R_a_b for turns of b by roll, pitch and yaw [rad] about the axes x, y and z of a, in this order; shape (3, 3)."""
    roll, pitch, yaw = angles
    return rotation_z(yaw) @ rotation_y(pitch) @ rotation_x(roll)


def rotation_from_vector(vector: FloatArray) -> FloatArray:
    """R_a_b, shape (..., 3, 3), for turns of b by vectors in the axes of a, shape (..., 3) [rad]."""
    vector = np.array(vector, dtype=float)  # SciPy reads no array that is locked
    R_a_b: FloatArray = rotations().from_rotvec(vector.reshape(-1, 3)).as_matrix().reshape(*vector.shape, 3)
    return R_a_b


def vector_from_rotation(R_a_b: FloatArray) -> FloatArray:
    """The shortest vectors, shape (..., 3) [rad], with which `rotation_from_vector` gives R_a_b, shape (..., 3, 3).

    By the quaternion, as Markley takes it from the trace (Journal of Guidance, Control, and Dynamics 31, 2008, page
    440). SciPy does so too, after it has made sure of every matrix, which takes most of its time; it is asked for the
    wide turns, of which the trace tells little.
    """
    R_a_b = np.asarray(R_a_b, dtype=float)
    R = R_a_b.reshape(-1, 3, 3)
    trace = R[:, 0, 0] + R[:, 1, 1] + R[:, 2, 2]
    vector: FloatArray = np.empty((len(R), 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.subtract(R[:, k, j], R[:, j, k], out=vector[:, i])
    sine, cosine = np.sqrt((vector**2).sum(axis=1)), 1.0 + trace
    still = sine == 0.0
    half = np.where(still, 1.0, np.arctan2(sine, cosine)) / np.where(still, cosine, sine)
    vector *= 2.0 * half[:, None]
    wide = trace <= 0.0
    if wide.any():
        vector[wide] = rotations().from_matrix(R[wide]).as_rotvec()
    return vector.reshape(R_a_b.shape[:-1])


def displacement(twist: FloatArray) -> FloatArray:
    """Transforms, shape (..., 4, 4), that move and turn by twists, shape (..., 6) [m, rad], each part for itself."""
    twist = np.asarray(twist, dtype=float)
    T_a_b = np.zeros((*twist.shape[:-1], 4, 4))
    T_a_b[..., :3, :3] = rotation_from_vector(twist[..., 3:])
    T_a_b[..., :3, 3] = twist[..., :3]
    T_a_b[..., 3, 3] = 1.0
    return T_a_b


def apply_twist(T_a_b: FloatArray, twist: FloatArray) -> FloatArray:
    """Move frames b by small twists given in the axes of frame a, taken at the origin of b.

    Args:
        T_a_b: Poses of b in a, shape (..., 4, 4).
        twist: Translation [m] and rotation vector [rad], shape (..., 6).

    Returns:
        The displaced T_a_b, shape (..., 4, 4).
    """
    moved = displacement(twist)
    moved[..., :3, :3] = moved[..., :3, :3] @ T_a_b[..., :3, :3]
    moved[..., :3, 3] += T_a_b[..., :3, 3]
    return moved


def twist_between(T_a_b: FloatArray, T_a_c: FloatArray) -> FloatArray:
    """Twists, shape (..., 6) [m, rad], axes of a, that `apply_twist` needs to move b onto c, shapes (..., 4, 4)."""
    turn = vector_from_rotation(T_a_c[..., :3, :3] @ np.swapaxes(T_a_b[..., :3, :3], -1, -2))
    return np.concatenate([T_a_c[..., :3, 3] - T_a_b[..., :3, 3], turn], axis=-1)


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Cross products of vectors, shapes (..., 3) that fit each other.

    What `numpy.cross` gives to the last bit; that one takes three times as long to find out which axes are meant, and a
    door has over a thousand of them.
    """
    a0, a1, a2 = a[..., 0], a[..., 1], a[..., 2]
    b0, b1, b2 = b[..., 0], b[..., 1], b[..., 2]
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
    product[..., 0] = a1 * b2 - a2 * b1
    product[..., 1] = a2 * b0 - a0 * b2
    product[..., 2] = a0 * b1 - a1 * b0
    return product


def shift_wrench(wrench: FloatArray, arm: FloatArray) -> FloatArray:
    """The same load, stated at another point: M_new = M_old - arm x F.

    Args:
        wrench: Force and moment at the old point, shape (..., 6) [N, N m].
        arm: From the old point to the new one, same axes, shape (..., 3) [m].

    Returns:
        The wrench at the new point, shape (..., 6).
    """
    wrench = np.asarray(wrench, dtype=float)
    moment = wrench[..., 3:] - cross(np.asarray(arm, dtype=float), wrench[..., :3])
    return np.concatenate([wrench[..., :3], moment], axis=-1)


def rotate_wrench(R_a_b: FloatArray, wrench_b: FloatArray) -> FloatArray:
    """Write a wrench in other axes; the point it acts at stays.

    Args:
        R_a_b: Rotations, shape (..., 3, 3).
        wrench_b: Force and moment in the axes of b, shape (..., 6) [N, N m].

    Returns:
        The wrench in the axes of a, shape (..., 6).
    """
    wrench_b = np.asarray(wrench_b, dtype=float)
    force = np.einsum("...ij,...j->...i", R_a_b, wrench_b[..., :3])
    moment = np.einsum("...ij,...j->...i", R_a_b, wrench_b[..., 3:])
    return np.concatenate([force, moment], axis=-1)
