"""A controller whose servo loops follow late, all as one of first order."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import interp1d
from scipy.signal import lsim

from doormill_ros.arrays import FloatArray

FINER = 10.0  #: steps of a time constant


def lagging(time: FloatArray, points: FloatArray, lag: float) -> FloatArray:
    """Where the tool is that strives after a path, at rest at its begin.

    Args:
        time: Of the samples, never less than before, shape (n,) [s].
        points: Where it is sent, shape (n, 3) [m].
        lag: Time constant [s].

    Returns:
        Shape (n, 3) [m].
    """
    if lag == 0.0 or time[-1] <= time[0]:
        return points
    last = np.append(np.diff(time) > 0.0, True)  # of several at one time, the one that is gone on from
    steps = np.linspace(time[0], time[-1], max(2, int(np.ceil((time[-1] - time[0]) * FINER / lag)) + 1))
    sent = interp1d(time[last], points[last] - points[0], axis=0)(steps)
    followed = [lsim(([1.0], [lag, 1.0]), column, steps - steps[0])[1] for column in sent.T]
    found: FloatArray = points[0] + interp1d(steps, np.transpose(followed), axis=0)(time)
    return found
