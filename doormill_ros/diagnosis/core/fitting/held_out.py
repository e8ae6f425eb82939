"""What rows left out say: solutions that have not seen them, what a cause gains there, and how sure a number is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

import numpy as np

from doormill_ros.arrays import FloatArray

#: A solution of whatever kind.
T = TypeVar("T")


def left_out(
    H: FloatArray,
    g: FloatArray,
    parts: Iterable[tuple[FloatArray, FloatArray]],
    solve: Callable[[FloatArray, FloatArray], T],
) -> Iterator[T]:
    """The solution without each part of the data, exact for what is linear in its numbers.

    Args:
        H: Normal equations H x = g of all rows, shape (m, m).
        g: Their right side, shape (m,).
        parts: The same of the rows of each part.
        solve: Solves what is left.
    """
    for own, pull in parts:
        yield solve(H - own, g - pull)


def gain_in_errors(fall: FloatArray) -> float:
    """Sum of what blocks left out gain, shape (blocks,), over its standard error by the scatter of the blocks."""
    if len(fall) < 2:
        return 0.0
    return float(fall.sum() / max(float(fall.std(ddof=1)) * np.sqrt(len(fall)), 1e-300))


def gain_in_expected_errors(fall: FloatArray, expected: FloatArray) -> float:
    """Sum of what blocks left out gain over its standard error, where it is known in what proportion they should.

    A cause that acts in a few blocks alone is not penalised because the others gain nothing.

    Args:
        fall: What each gains, shape (blocks,).
        expected: What each gains where the cause is true, shape (blocks,).
    """
    count, whole = len(fall), float(expected.sum())
    if count < 2 or whole <= 0.0:
        return 0.0
    off = fall - float(fall.sum()) / whole * expected
    return float(fall.sum() / max(float(np.sqrt(np.sum(off**2) * count / (count - 1))), 1e-300))


def scatter_of(pulls: FloatArray, covariance: FloatArray) -> FloatArray:
    """Standard deviations, shape (m,), from how far blocks whose rows err alike pull a solution apart.

    Args:
        pulls: Descent that each block has left at the common solution, shape (blocks, m).
        covariance: Inverse of the normal equations, shape (m, m).
    """
    shifts = pulls @ covariance
    result: FloatArray = np.sqrt(np.sum(shifts**2, axis=0) * len(pulls) / max(len(pulls) - 1, 1))
    return result
