"""Where a tool goes that follows its commands late, as one servo loop of first order makes it."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray

#: Time constants that are tried [s]: what one between neighbours leaves is little beside what it explains.
LAGS = (0.003, 0.006, 0.012, 0.017, 0.024, 0.034, 0.048)
_STILL = 1e-9  #: ways below this are none [m]


def aside(time: FloatArray, points: FloatArray) -> FloatArray:
    """How far beside a path the tool passes at each of its points, for each of `LAGS`; shape (m, lags, 3) [m].

    With T y' = x - y (exact where the command x runs evenly between samples) the tool is behind by T, and passes where
    the command had been a time T before; what is left of that on an arc is (T v)^2 / 2 times its curvature. Where it is
    sent nowhere else for longer than T it arrives.

    Args:
        time: Of the samples, never less than before, shape (m,) [s]; several at one time are a jump.
        points: Of the path, shape (m, 3) [m].
    """
    lags = np.array(LAGS)[:, None]
    behind = np.zeros((len(points), len(LAGS), 3))
    lasting, step = np.diff(time), np.diff(points, axis=0)
    for i, (dt, way) in enumerate(zip(lasting, step, strict=True)):
        if dt > 0.0:
            left = np.exp(-dt / lags)
            behind[i + 1] = behind[i] * left - lags * way / dt * (1.0 - left)
    found = np.empty_like(behind)
    for k, lag in enumerate(LAGS):
        tool = points + behind[:, k]
        passes = np.minimum(time + lag, _leaving(time, points, lag))
        for axis in range(3):
            found[:, k, axis] = np.interp(passes, time, tool[:, axis]) - points[:, axis]
    return found


def _leaving(time: FloatArray, points: FloatArray, least: float) -> FloatArray:
    """When the next stop of more than `least` ends, from each sample on, shape (m,) [s]; infinite for none."""
    stands = np.linalg.norm(np.diff(points, axis=0), axis=1) < _STILL
    edges = np.flatnonzero(np.diff(np.concatenate([[False], stands, [False]]).astype(int)))
    begins, ends = time[edges[::2]], time[edges[1::2]]
    ends = np.append(ends[ends - begins > least], np.inf)
    found: FloatArray = ends[np.searchsorted(ends, time)]
    return found
