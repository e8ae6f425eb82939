"""Inverse condition number of the normalized Jacobian: how far a posture is from singularity."""

from __future__ import annotations

import numpy as np

from doormill_ros.robot.chain import JOINTS, ChainFrames
from doormill_ros.robot.denavit_hartenberg import A, D
from doormill_ros.robot.description import Robot


def characteristic_length(robot: Robot) -> float:
    """L_c = R_r / R_m of thesis eq. 3.37 and 3.38, read in metres.

    R_r is the reach of the data sheet (to the wrist centre), R_m the sum of the distances between
    neighbouring joint origins out to the flange. The quotient has no unit, so as a length it is a
    convention: about one metre for any arm whose data sheet counts its reach to the wrist.
    """
    dh = robot.dh
    stretched = dh[0, A] + dh[1, A] + np.hypot(dh[2, A], dh[3, D]) + abs(dh[5, D])
    return float(robot.reach / stretched)


def inverse_condition_number(frames: ChainFrames, velocity: np.ndarray, length: float) -> np.ndarray:
    """1 / (|J_n| |J_n^-1|) in the Frobenius norm, shape (n,) [-] (thesis eq. 3.36 to 3.39).

    0 in a singularity; at most 1/6, for a matrix whose singular values are all equal. (Angeles
    divides both norms by the square root of 6 and so ends at 1; the thesis' script does not.)

    J_n = Q R leaves both norms to R. Gram-Schmidt in its modified form gives R as accurately as
    reflections do, also near singularities, and runs over all configurations at once.

    Args:
        frames: Frames of n configurations.
        velocity: Translational Jacobian, shape (6, 3, n), of `jacobian_columns`.
        length: Characteristic length that makes the Jacobian homogeneous [m].
    """
    n = velocity.shape[-1]
    columns = np.empty((JOINTS, 6, n))
    np.multiply(velocity, 1.0 / length, out=columns[:, :3])
    columns[:, 3:] = frames.z[:JOINTS]
    norm_squared = np.einsum("jin,jin->n", columns, columns)
    R = np.empty((JOINTS, JOINTS, n))
    for j in range(JOINTS):
        size = np.sqrt(np.einsum("in,in->n", columns[j], columns[j]))
        R[j, j] = size
        if j + 1 < JOINTS:
            unit = columns[j] / np.maximum(size, np.finfo(float).tiny)
            np.einsum("in,kin->kn", unit, columns[j + 1 :], out=R[j, j + 1 :])
            columns[j + 1 :] -= R[j, j + 1 :, None] * unit
    return 1.0 / np.sqrt(norm_squared * _inverse_norm_squared(R))


def _inverse_norm_squared(R: np.ndarray) -> np.ndarray:
    """Squared Frobenius norm of the inverse of upper triangular matrices, shape (6, 6, n)."""
    # A zero on the diagonal becomes a number so large that the condition number ends at zero
    # without a division by zero on the way.
    pivot = 1.0 / np.maximum(np.einsum("jjn->jn", R), 1e-60)
    inverse = np.empty_like(R)
    total = np.zeros(R.shape[-1])
    for column in range(JOINTS):
        inverse[column, column] = pivot[column]
        for row in range(column - 1, -1, -1):
            part = np.einsum("kn,kn->n", R[row, row + 1 : column + 1], inverse[row + 1 : column + 1, column])
            part *= pivot[row]
            np.negative(part, out=inverse[row, column])
        total += np.einsum("kn,kn->n", inverse[: column + 1, column], inverse[: column + 1, column])
    return total
