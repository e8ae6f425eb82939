"""Inverse condition number of the normalized Jacobian: how far a posture is from singularity."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
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


def inverse_condition_number(frames: ChainFrames, velocity: FloatArray, length: float) -> FloatArray:
    """1 / (|J_n| |J_n^-1|) in the Frobenius norm, shape (n,) [-] (thesis eq. 3.36 to 3.39).

    0 in a singularity; at most 1/6, for a matrix whose singular values are all equal. (Angeles
    divides both norms by the square root of 6 and so ends at 1; the thesis' script does not.)

    Gram-Schmidt in its modified form, J_n = Q U with unit upper triangular U and columns of Q at right
    angles but of any length, is as accurate as reflections are and runs over all configurations at
    once. With D the squared lengths of those columns |J_n^-1|^2 = |U^-1 D^-1/2|^2.

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
    U = np.empty((JOINTS, JOINTS, n))
    per_length = np.empty((JOINTS, n))  # 1 / D
    part = np.empty((6, n))
    for j in range(JOINTS):
        squared = np.einsum("in,in->n", columns[j], columns[j])
        # A column that vanishes becomes a number so small that the result ends at zero without a
        # division by zero on the way.
        np.divide(1.0, np.maximum(squared, 1e-150), out=per_length[j])
        if j + 1 < JOINTS:
            np.einsum("in,kin->kn", columns[j], columns[j + 1 :], out=U[j, j + 1 :])
            U[j, j + 1 :] *= per_length[j]
            for k in range(j + 1, JOINTS):
                np.multiply(columns[j], U[j, k], out=part)
                columns[k] -= part
    number: FloatArray = np.sqrt(norm_squared * _inverse_norm_squared(U, per_length))
    return 1.0 / number


def _inverse_norm_squared(U: FloatArray, per_length: FloatArray) -> FloatArray:
    """|U^-1 D^-1/2|^2, shape (n,), of unit upper triangular U, shape (6, 6, n), and 1 / D, (6, n)."""
    inverse = np.empty_like(U)
    total: FloatArray = per_length.sum(axis=0)
    for column in range(1, JOINTS):
        inverse[column, column] = 1.0
        for row in range(column - 1, -1, -1):
            known = inverse[row + 1 : column + 1, column]
            np.einsum("kn,kn->n", U[row, row + 1 : column + 1], known, out=inverse[row, column])
            np.negative(inverse[row, column], out=inverse[row, column])
        above = np.einsum("kn,kn->n", inverse[:column, column], inverse[:column, column])
        above *= per_length[column]
        total += above
    return total
