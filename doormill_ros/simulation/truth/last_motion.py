"""Which way each joint moved last: a joint with backlash lies against the flank of that side."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray

#: Joint motions below this are standing still [rad].
STILL = 1e-9


def last_directions(q: FloatArray) -> FloatArray:
    """Direction of each joint's last motion, -1 or +1, 0 before its first; shape (n, 6)."""
    signs = np.zeros_like(q)
    steps = np.diff(q, axis=0)
    signs[1:] = np.sign(np.where(np.abs(steps) > STILL, steps, 0.0))
    # Where a joint stands still its last motion counts: index of the last sample that moved.
    moved = np.where(signs != 0.0, np.arange(len(q))[:, None], 0)
    last = np.maximum.accumulate(moved, axis=0)
    return np.take_along_axis(signs, last, axis=0)
