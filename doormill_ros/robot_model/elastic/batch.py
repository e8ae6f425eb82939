"""Elastostatics of many configurations at once, arrays with the configurations last."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.chain import JOINTS, ChainFrames, cross, dot

_SAFE_PIVOT = 0.1  # share of a joint's stiffness below which elimination without pivoting stops


def joint_torque(frames: ChainFrames, velocity: FloatArray, wrench: FloatArray) -> FloatArray:
    """J^T W, shape (6, n) [N m] (thesis eq. 2.34).

    Args:
        frames: Frames of n configurations.
        velocity: Translational Jacobian at the load point, shape (6, 3, n), of `jacobian_columns`.
        wrench: Force and moment at the load point, base axes, shape (6, n) or (6, 1) [N, N m].
    """
    return dot(velocity, wrench[:3]) + dot(frames.z[:JOINTS], wrench[3:])


def twist(frames: ChainFrames, velocity: FloatArray, dq: FloatArray) -> FloatArray:
    """J dq, shape (6, n) [m, rad], of joint motions dq, shape (6, n) [rad] (thesis eq. 2.32)."""
    result = np.empty((6, dq.shape[-1]))
    np.einsum("jin,jn->in", velocity, dq, out=result[:3])
    np.einsum("jin,jn->in", frames.z[:JOINTS], dq, out=result[3:])
    return result


def complementary(frames: ChainFrames, velocity: FloatArray, wrench: FloatArray) -> FloatArray:
    """K_c[j, k] = (d J_j / d q_k) . W, shape (6, 6, n) [N m/rad] (thesis eq. 2.38).

    With the exact Hessian columns of `Kinematics.hessian` and the triple product turned so that
    one vector product a joint serves a whole row or column:

        k <= j:  z_k . (v_j x F + z_j x M)
        k >  j:  z_j . (v_k x F)
    """
    z = frames.z[:JOINTS]
    by_force = cross(velocity, wrench[:3])  # (6, 3, n)
    by_both = cross(z, wrench[3:])
    by_both += by_force
    result = np.empty((JOINTS, JOINTS, velocity.shape[-1]))
    for j in range(JOINTS):
        np.einsum("kin,in->kn", z[: j + 1], by_both[j], out=result[j, : j + 1])
        if j + 1 < JOINTS:
            np.einsum("kin,in->kn", by_force[j + 1 :], z[j], out=result[j, j + 1 :])
    return result


def solve_springs(stiffness: FloatArray, K_c: FloatArray, torque: FloatArray) -> FloatArray:
    """(K_theta - K_c)^-1 tau, shape (6, n) [rad].

    K_theta dominates K_c by orders of magnitude for any load a robot carries, so elimination
    needs no pivoting; should a pivot shrink, LAPACK takes over with pivoting.

    Args:
        stiffness: Joint stiffness, shape (6,) [N m/rad].
        K_c: Complementary stiffness, shape (6, 6, n) [N m/rad].
        torque: Joint torques, shape (6, n) [N m].
    """
    matrix = -K_c
    for joint in range(JOINTS):
        matrix[joint, joint] += stiffness[joint]
    right = torque.copy()
    for p in range(JOINTS):
        if matrix[p, p].min() < _SAFE_PIVOT * stiffness[p]:
            full = np.diag(stiffness) - K_c.transpose(2, 0, 1)
            return np.asarray(np.linalg.solve(full, torque.T[..., None])[..., 0].T, dtype=float)
        if p + 1 < JOINTS:
            factor = matrix[p + 1 :, p] / matrix[p, p]  # (5 - p, n)
            matrix[p + 1 :, p + 1 :] -= factor[:, None] * matrix[p, p + 1 :]
            right[p + 1 :] -= factor * right[p]
    for p in range(JOINTS - 1, -1, -1):
        for k in range(p + 1, JOINTS):
            right[p] -= matrix[p, k] * right[k]
        right[p] /= matrix[p, p]
    return right
