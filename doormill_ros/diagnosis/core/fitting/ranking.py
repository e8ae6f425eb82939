"""Ranks scores alike on every machine: what differs by rounding alone is a tie, and ties go by a fixed order."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray

#: Scores closer than this are equal. A score is a sum of squared standard deviations: a difference of 1 is an odds
#: ratio of 1.6, one of a thousandth says nothing, and rounding moves the scores of hundreds of trials by 1e-8.
QUANTUM = 1e-3

Item = TypeVar("Item")


def ranks(scores: FloatArray, quantum: float = QUANTUM) -> IntArray:
    """Indices of scores, the smallest first, those within a quantum of the least of the rest in their own order.

    Args:
        scores: Shape (n,).
        quantum: Difference up to which scores are equal.

    Returns:
        Shape (n,).
    """
    scores = np.asarray(scores, dtype=float)
    by_size = np.argsort(scores, kind="stable")
    ordered = scores[by_size]
    groups, start = [np.zeros(0, dtype=int)], 0
    while start < len(ordered):
        # The least itself is always in, also where it is infinite or not a number.
        end = max(int(np.searchsorted(ordered, ordered[start] + quantum, "right")), start + 1)
        groups.append(np.sort(by_size[start:end]))
        start = end
    return np.concatenate(groups)


def ranked(
    items: Iterable[Item], score: Callable[[Item], float], order: Callable[[Item], Any] | None = None
) -> list[Item]:
    """Items by their scores, the smallest first; equal ones by a key, or as they came."""
    listed = list(items) if order is None else sorted(items, key=order)
    return [listed[i] for i in ranks(np.array([score(item) for item in listed]))]


def first_largest(values: FloatArray, share: float = 1e-6) -> int:
    """Index of the first of some values, shape (n,), that is the largest to within a share of it."""
    largest = float(np.max(values))
    return int(np.flatnonzero(values >= largest - share * abs(largest))[0])
