"""By how much one more effect explains what is left, to first order."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray

_RIDGE = 1e-9  #: share of the mean square of the columns, for those that hardly differ


def gain_of(columns: FloatArray, left: FloatArray) -> float:
    """By how much the sum of squares falls.

    Args:
        columns: Whitened derivatives of the rows by the effect, shape (n, p).
        left: Whitened rows, shape (n,).
    """
    gram = columns.T @ columns
    gram += _RIDGE * max(float(np.trace(gram)), 1e-12) * np.eye(len(gram))
    pull = columns.T @ left
    return float(pull @ np.linalg.solve(gram, pull))
