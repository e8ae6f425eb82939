"""Rotation matrices to unit quaternions and back, to the last bit as SciPy does it.

SciPy's rotations take a fifth of the start of a node that only passes poses on: with them come trees, graphs and
optimizers. They are asked where they are loaded anyway, as they are quicker, and for what is no rotation.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray

#: SciPy makes the nearest rotation of a matrix whose R R^T is further off.
ORTHOGONAL = 1e-12


def rotations() -> Any:
    """SciPy's class of rotations, imported late."""
    from scipy.spatial.transform import Rotation

    return Rotation


def _loaded() -> Any:
    """The same where somebody has imported it; else None."""
    return getattr(sys.modules.get("scipy.spatial.transform"), "Rotation", None)


def quaternion_of(R_a_b: FloatArray) -> FloatArray:
    """Unit quaternions (x, y, z, w) with w >= 0, shape (..., 4), of matrices, shape (..., 3, 3).

    Raises:
        ValueError: A matrix turns nothing: its determinant is not positive.
    """
    R_a_b = np.asarray(R_a_b, dtype=float)
    if (loaded := _loaded()) is not None:
        return loaded.from_matrix(R_a_b).as_quat(canonical=True)  # type: ignore[no-any-return]
    R = R_a_b.reshape(-1, 3, 3)
    off = np.abs(R @ np.swapaxes(R, 1, 2) - np.eye(3))
    if not (np.all(off <= ORTHOGONAL) and np.all(np.linalg.det(R) > 0.0)):
        found: FloatArray = rotations().from_matrix(R_a_b).as_quat(canonical=True)
        return found
    trace = R[:, 0, 0] + R[:, 1, 1] + R[:, 2, 2]
    largest = np.argmax(np.stack([R[:, 0, 0], R[:, 1, 1], R[:, 2, 2], trace], axis=1), axis=1)
    q = np.empty((len(R), 4))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        chosen = largest == i
        M = R[chosen]
        q[chosen, i] = 1.0 - trace[chosen] + 2.0 * M[:, i, i]
        q[chosen, j] = M[:, j, i] + M[:, i, j]
        q[chosen, k] = M[:, k, i] + M[:, i, k]
        q[chosen, 3] = M[:, k, j] - M[:, j, k]
    chosen = largest == 3
    M = R[chosen]
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        q[chosen, i] = M[:, k, j] - M[:, j, k]
    q[chosen, 3] = 1.0 + trace[chosen]
    q /= _norms(q)
    # Of two quaternions of one turn the one whose last number that is not zero, from w on, is positive.
    w, x, y, z = q[:, 3], q[:, 0], q[:, 1], q[:, 2]
    negative = (w < 0) | ((w == 0) & ((x < 0) | ((x == 0) & ((y < 0) | ((y == 0) & (z < 0))))))
    q[negative] *= -1.0
    return q.reshape(*R_a_b.shape[:-2], 4)


def matrix_of(quaternion: FloatArray) -> FloatArray:
    """Rotation matrices, shape (..., 3, 3), of quaternions (x, y, z, w) of any positive norm, shape (..., 4).

    Raises:
        ValueError: A quaternion is zero.
    """
    given = np.asarray(quaternion, dtype=float)
    if (loaded := _loaded()) is not None:
        return loaded.from_quat(given).as_matrix()  # type: ignore[no-any-return]
    norms = _norms(given)
    if not np.all(norms > 0.0):
        found: FloatArray = rotations().from_quat(given).as_matrix()
        return found
    x, y, z, w = np.moveaxis(given / norms, -1, 0)
    x2, y2, z2, w2 = x * x, y * y, z * z, w * w
    xy, zw, xz, yw, yz, xw = x * y, z * w, x * z, y * w, y * z, x * w
    rows = [
        [x2 - y2 - z2 + w2, 2.0 * (xy - zw), 2.0 * (xz + yw)],
        [2.0 * (xy + zw), -x2 + y2 - z2 + w2, 2.0 * (yz - xw)],
        [2.0 * (xz - yw), 2.0 * (yz + xw), -x2 - y2 + z2 + w2],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _norms(quaternion: FloatArray) -> FloatArray:
    """Lengths, shape (..., 1)."""
    x, y, z, w = np.moveaxis(quaternion, -1, 0)
    lengths: FloatArray = np.sqrt(x * x + y * y + z * z + w * w)[..., None]
    return lengths
