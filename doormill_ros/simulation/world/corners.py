"""A controller that lags: corners that it passes without a stop are cut."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray

STILL = 1e-9  #: ways below this are none [m]
#: Way over which the mean of a right angle lies as far from it as the corner is cut, over that cut: on each leg the
#: mean lies an eighth of the way along, so the cut is sqrt(2) / 8 of it.
WINDOW = 8.0 / np.sqrt(2.0)


def cut_corners(time: FloatArray, points: FloatArray, cut: float) -> FloatArray:
    """The path as a mean over a stretch of itself, shorter towards places where the robot stands.

    Args:
        time: Shape (n,) [s].
        points: Shape (n, 3) [m].
        cut: How far from a right angle with long legs the path passes [m].

    Returns:
        Shape (n, 3) [m].
    """
    if cut == 0.0 or len(points) < 2:
        return points
    way = np.linalg.norm(np.diff(points, axis=0), axis=1)
    # Two samples of one place and different times: the robot came to rest there.
    stands = np.flatnonzero((way < STILL) & (np.diff(time) > 0.0))
    rounded = points.copy()
    first = 0
    for last in (*stands, len(points) - 1):
        rounded[first : last + 1] = _mean(points[first : last + 1], 0.5 * WINDOW * cut)
        first = last + 1
    return rounded


def _mean(points: FloatArray, half: float) -> FloatArray:
    """Mean over `half` [m] of way to either side, less where the path begins or ends sooner; shape (n, 3)."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    kept = np.concatenate([[True], steps > STILL])
    knots = points[kept]
    if len(knots) < 2:
        return points
    at_knot = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(knots, axis=0), axis=1))])
    at = np.concatenate([[0.0], np.cumsum(np.where(kept[1:], steps, 0.0))])
    at = np.clip(at, 0.0, at_knot[-1])
    sums = np.concatenate(
        [np.zeros((1, 3)), np.cumsum(0.5 * (knots[1:] + knots[:-1]) * np.diff(at_knot)[:, None], axis=0)]
    )

    def integral(s: FloatArray) -> FloatArray:
        k = np.clip(np.searchsorted(at_knot, s, side="right") - 1, 0, len(knots) - 2)
        into = (s - at_knot[k])[:, None]
        slope = (knots[k + 1] - knots[k]) / (at_knot[k + 1] - at_knot[k])[:, None]
        found: FloatArray = sums[k] + knots[k] * into + 0.5 * slope * into**2
        return found

    reach = np.minimum(half, np.minimum(at, at_knot[-1] - at))
    inner = reach > STILL
    mean = points.copy()
    mean[inner] = (integral((at + reach)[inner]) - integral((at - reach)[inner])) / (2.0 * reach[inner, None])
    return mean
