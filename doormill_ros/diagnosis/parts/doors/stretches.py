"""Stretches of wall that are left out together: neighbours know too much of each other."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray

LENGTH = 0.02  #: of a stretch [m]


def stretches(points: FloatArray, surface: IntArray) -> IntArray:
    """Number of the stretch of each point, shape (n,): round its surface, in whatever order the points came.

    Args:
        points: Shape (n, 3) [m].
        surface: Number of the surface that each lies on, shape (n,).
    """
    found, count = np.zeros(len(points), dtype=int), 0
    for number in np.unique(surface):
        rows = np.flatnonzero(surface == number)
        away = points[rows] - points[rows].mean(axis=0)
        first, second = np.argsort(-np.ptp(away, axis=0), kind="stable")[:2]  # the plane in which it lies
        order = np.argsort(np.arctan2(away[:, second], away[:, first]), kind="stable")
        way = np.cumsum(np.linalg.norm(np.diff(away[order], axis=0, prepend=away[order[:1]]), axis=1))
        stretch = np.unique((way / LENGTH).astype(int), return_inverse=True)[1].ravel()
        found[rows[order]] = count + stretch
        count += int(stretch.max()) + 1
    return found
