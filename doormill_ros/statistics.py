"""Robust statistics: scales and weights that gross errors cannot bend, and intervals by resampling.

Medians are taken without the checks on which NumPy's own spends most of its time; values are finite.
"""

from __future__ import annotations

from functools import reduce

import numpy as np
from numpy.typing import ArrayLike

from doormill_ros.arrays import BoolArray, Float32Array, FloatArray, IntArray

#: Standard deviation of a normal distribution in its median absolute deviations.
NORMAL_STD = 1.4826
#: Median of the chi-square distribution by its degrees of freedom.
CHI_SQUARE_MEDIAN = {1: 0.455, 2: 1.386, 3: 2.366, 4: 3.357, 5: 4.351, 6: 5.348}
#: Largest share of measurements that can be gross errors; more of them are structure.
GROSS_SHARE = 0.1


def median(values: FloatArray | Float32Array) -> float:
    """Upper median of values of any shape, at least one."""
    flat = values.flatten()
    middle = flat.size // 2
    flat.partition(middle)
    return float(flat[middle])


def row_medians(values: Float32Array) -> Float32Array:
    """Upper median of each row of (..., m), shape (...)."""
    rows = np.array(values, order="C")
    rows.sort(axis=-1)  # rows are short, and sooner sorted than partitioned
    middles: Float32Array = rows[..., values.shape[-1] // 2]
    return middles


def running_means(values: Float32Array, count: int) -> Float32Array:
    """Means of so many neighbours along the last axis of (..., m), shape (..., m - count + 1)."""
    last = values.shape[-1] - count + 1
    means: Float32Array = reduce(np.add, (values[..., i : last + i] for i in range(count))) / np.float32(
        count
    )
    return means


def root_mean_square(values: ArrayLike) -> float:
    """Root of the mean of the squares of values, at least one and of any shape, in their unit."""
    return float(np.sqrt(np.mean(np.square(values))))


def share(chosen: BoolArray) -> float:
    """Share of the elements of an array, not empty and of any shape, that are true."""
    return float(np.count_nonzero(chosen) / chosen.size)


def median_length(components: int) -> float:
    """Median of the length of a vector of that many (1 to 6) independent standard normal numbers."""
    return float(np.sqrt(CHI_SQUARE_MEDIAN[components]))


def huber_weights(size: FloatArray, limit: float) -> FloatArray:
    """Weights that let a residual beyond a limit pull no harder than one at the limit.

    Args:
        size: Absolute residuals in any unit, shape (n,).
        limit: Largest residual that keeps its full weight, in the same unit.

    Returns:
        1 up to the limit and limit / size beyond, shape (n,).
    """
    return 1.0 / np.maximum(1.0, size / limit)


def bootstrap_ratio(
    before: FloatArray, after: FloatArray, draws: int = 20_000
) -> tuple[float, tuple[float, float]]:
    """Ratio of root sums of squares after and before, with its 95 % interval from resampling the groups.

    Args:
        before: Sum of squares of each group of measurements before, shape (n,).
        after: The same groups after, shape (n,).
        draws: How often n groups are drawn with replacement.

    Returns:
        The ratio of all groups, and the lower and the upper end of its interval; 1 where all squares before are zero.
    """
    drawn = resampled(len(before), draws)
    squares = before[drawn].sum(axis=1)
    # Single runs of a door each may agree with their model to the last digit: nothing of nothing is no ratio.
    telling = squares > 0.0
    if not telling.any():
        return 1.0, (1.0, 1.0)
    ratios = np.sqrt(after[drawn[telling]].sum(axis=1) / squares[telling])
    low, high = np.quantile(ratios, [0.025, 0.975])
    return float(np.sqrt(after.sum() / before.sum())), (float(low), float(high))


def resampled(count: int, draws: int, seed: int = 0) -> IntArray:
    """Rows drawn with replacement, the same with every version of NumPy.

    NumPy promises the raw words of a bit generator and not what its Generator makes of them.

    Args:
        count: Number of rows, below 2^32.
        draws: Number of samples, each of `count` rows.
        seed: Start of the stream.

    Returns:
        Indices of rows, shape (draws, count).
    """
    size = draws * count
    words = np.random.PCG64(seed).random_raw((size + 1) // 2)
    halves = np.stack([words & np.uint64(0xFFFFFFFF), words >> np.uint64(32)], axis=1).ravel()[:size]
    return ((halves * np.uint64(count)) >> np.uint64(32)).astype(np.int64).reshape(draws, count)


def uniform(shape: tuple[int, ...], seed: int = 0) -> FloatArray:
    """Numbers in [0, 1) of a shape, the top 53 bits of each word; the same with every version of NumPy."""
    words = np.random.PCG64(seed).random_raw(int(np.prod(shape)))
    return (words >> np.uint64(11)).astype(float).reshape(shape) * 2.0**-53
