"""Medians and shares without the checks on which the library's own spend most of their time."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray


def median(values: FloatArray) -> float:
    """Upper median of values of any shape, at least one."""
    flat = values.flatten()
    middle = flat.size // 2
    flat.partition(middle)
    return float(flat[middle])


def share(chosen: FloatArray) -> float:
    """Share of the elements of an array, bool and not empty, that are true."""
    return float(np.count_nonzero(chosen) / chosen.size)


def column_medians(values: FloatArray) -> FloatArray:
    """Upper median of each column of (n, m), shape (m,)."""
    middle = len(values) // 2
    rows = np.ascontiguousarray(values.T)
    rows.partition(middle, axis=1)
    return rows[:, middle]
