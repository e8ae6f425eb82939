"""Series that were left out as a whole: placed by few rows of their own, all else known from other series."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.ridge import Solution
from doormill_ros.diagnosis.pose.fitting.linear import Linear
from doormill_ros.diagnosis.pose.fitting.placement import HUBER

#: Damping of a placement: directions that the poses leave open stay where they are.
_WHISPER = 3e-5


def place(linear: Linear, x: FloatArray) -> FloatArray:
    """Some solutions, shape (solutions, size), with the placement fitted to the rows that may place the series."""
    x = x.copy()
    x[:, linear.own] = 0.0
    J = np.swapaxes(linear.D[linear.placing][:, linear.free] * linear.scale, 1, 2)
    flat = J.reshape(-1, len(linear.own))
    start = linear.residuals(x, linear.placing) * linear.scale
    whisper = np.broadcast_to(_WHISPER * np.eye(len(linear.own)), (len(x), len(linear.own), len(linear.own)))
    for _ in range(3):
        error = start - (flat @ x[:, linear.own, None]).reshape(start.shape)
        size = np.linalg.norm(error, axis=2)
        usual = np.median(size, axis=1)[:, None]
        root = np.sqrt(linear.weight[linear.placing] / np.maximum(1.0, size / (HUBER * usual)))
        # Base and target hardly differ in few poses: by orthogonal steps, which lose half the digits of a sum.
        A = (J * root[:, :, None, None]).reshape(len(x), -1, len(linear.own))
        unit = 1.0 / np.linalg.norm(A, axis=1)
        Q, R = np.linalg.qr(np.concatenate([A * unit[:, None], whisper], axis=1))
        right = (error * root[:, :, None]).reshape(len(x), -1, 1)
        pull = np.swapaxes(Q[:, : A.shape[1]], 1, 2) @ right
        x[:, linear.own] += unit * np.linalg.solve(R, pull)[..., 0]
    return x


def variance(linear: Linear, solution: Solution, rows: IntArray, placed: bool) -> FloatArray:
    """Of predicted positions of rows, shape (len(rows), 3) [m^2]; `placed` if marked rows alone place the series.

    Then the placement takes up a part of what is wrong in the coefficients, and adds the noise of those rows.
    """
    A, C = linear.effect(rows, 3), solution.covariance
    noise = np.zeros((len(rows), 3))
    if placed and not linear.shared:
        marked = linear.effect(linear.placing, 6) * linear.scale[:, None]
        marked = marked.reshape(-1, len(solution.x))
        P = marked[:, linear.own]
        unit = 1.0 / np.linalg.norm(P, axis=0)
        inverse = np.linalg.inv((P * unit).T @ (P * unit) + _WHISPER**2 * np.eye(len(unit)))
        inverse *= np.outer(unit, unit)
        own = A[:, :, linear.own]
        noise = np.sum((own @ inverse) * own, axis=2)
        A = A - own @ (inverse @ (P.T @ marked))
        A[:, :, linear.own] = 0.0
    used = np.flatnonzero(np.any(A, axis=(0, 1)))
    flat = A[:, :, used].reshape(3 * len(rows), len(used))
    result: FloatArray = np.sum((flat @ C[np.ix_(used, used)]) * flat, axis=1).reshape(-1, 3) + noise
    return result
