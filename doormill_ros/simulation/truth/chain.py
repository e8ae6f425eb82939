"""Denavit-Hartenberg chain of the simulated truth, written apart from the robot package on purpose."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray


def turn(rotvec: FloatArray) -> FloatArray:
    """Rotation matrices of rotation vectors by Rodrigues' formula.

    Args:
        rotvec: Shape (n, 3) [rad].

    Returns:
        Shape (n, 3, 3).
    """
    angle = np.linalg.norm(rotvec, axis=1)
    axis = rotvec / np.where(angle > 0.0, angle, 1.0)[:, None]
    x, y, z = axis.T
    zero = np.zeros_like(x)
    skew = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    rotation: FloatArray = np.eye(3) + s * skew + (1.0 - c) * (skew @ skew)
    return rotation


def shift(rotation: FloatArray, translation: FloatArray) -> FloatArray:
    """Homogeneous matrices (n, 4, 4) from (n, 3, 3) and (n, 3) [m]."""
    matrix = np.zeros((len(rotation), 4, 4))
    matrix[:, :3, :3] = rotation
    matrix[:, :3, 3] = translation
    matrix[:, 3, 3] = 1.0
    return matrix


def joint_matrix(row: FloatArray, angle: FloatArray) -> FloatArray:
    """A_k = Rz(q + theta) Tz(d) Tx(a) Rx(alpha) (thesis eq. 2.2), multiplied out.

    Args:
        row: theta_offset [rad], d [m], a [m], alpha [rad], shape (4,).
        angle: Joint angle, shape (n,) [rad].

    Returns:
        Frame k in frame k-1, shape (n, 4, 4).
    """
    theta, d, a, alpha = row
    turned = angle + theta
    c, s = np.cos(turned), np.sin(turned)
    ca, sa = np.cos(alpha), np.sin(alpha)
    matrix = np.zeros((len(angle), 4, 4))
    matrix[:, 0, 0], matrix[:, 0, 1], matrix[:, 0, 2], matrix[:, 0, 3] = c, -s * ca, s * sa, a * c
    matrix[:, 1, 0], matrix[:, 1, 1], matrix[:, 1, 2], matrix[:, 1, 3] = s, c * ca, -c * sa, a * s
    matrix[:, 2, 1:] = sa, ca, d
    matrix[:, 3, 3] = 1.0
    return matrix


def chain(dh: FloatArray, q: FloatArray) -> FloatArray:
    """Frames 0 to 6 of the rigid robot in the base frame.

    Args:
        dh: Table, shape (6, 4).
        q: Joint angles, shape (n, 6) [rad].

    Returns:
        Shape (n, 7, 4, 4).
    """
    frames = [np.broadcast_to(np.eye(4), (len(q), 4, 4))]
    for k in range(6):
        frames.append(frames[-1] @ joint_matrix(dh[k], q[:, k]))
    return np.stack(frames, axis=1)
