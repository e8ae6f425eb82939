"""Joint angles that the poses visited; away from them nothing is claimed."""

from __future__ import annotations

from typing import Any

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis

BINS = 72  #: of a turn


def coverage(diagnosis: PoseDiagnosis) -> list[dict[str, Any]]:
    """Joint angles that were visited: turns of 360 deg / 72 with at least five rows, as ranges."""
    found = []
    for k in range(diagnosis.sets[0].joints):
        visited = covered(np.concatenate([data.q[:, k] for data in diagnosis.sets]))
        edges = np.flatnonzero(np.diff(np.concatenate([[False], visited, [False]]).astype(int)))
        ranges = [
            [float(a), float(b)] for a, b in (edges.reshape(-1, 2) * 2.0 * np.pi / BINS - np.pi).tolist()
        ]
        found.append({"joint": k + 1, "share_of_turn": float(visited.mean()), "ranges": ranges})
    return found


def bin_of(angle: FloatArray) -> IntArray:
    """Bin of a turn in which each angle lies, shape (n,) [rad]."""
    return (np.floor((angle + np.pi) * BINS / (2.0 * np.pi)).astype(int)) % BINS


def covered(angle: FloatArray) -> BoolArray:
    """Which bins of a turn hold at least five rows, shape (72,)."""
    return np.bincount(bin_of(angle), minlength=BINS) >= 5
