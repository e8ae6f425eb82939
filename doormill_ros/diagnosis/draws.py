"""Random numbers that stay the same on every machine and with every NumPy.

NumPy promises the raw stream of a bit generator; how `Generator` turns it into integers, permutations and normal
numbers may change with any release.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray

#: Resamples of a bootstrap: its interval then moves by less than a hundredth of its width from seed to seed.
RESAMPLES = 20_000
_AT_ONCE = 2_000


def uniform(seed: int, shape: tuple[int, ...]) -> FloatArray:
    """Numbers in [0, 1), the top 53 bits of each word of the stream."""
    words = np.random.PCG64(seed).random_raw(int(np.prod(shape)))
    return (np.asarray(words, dtype=np.uint64) >> np.uint64(11)).astype(float).reshape(shape) * 2.0**-53


def integers(seed: int, below: int, shape: tuple[int, ...]) -> IntArray:
    """Integers 0 ... below - 1, all as likely to within `below` / 2^53."""
    return (uniform(seed, shape) * below).astype(np.int64)


def ratio_interval(before: FloatArray, after: FloatArray) -> tuple[float, tuple[float, float]]:
    """Ratio of two root mean squares and its 95 % interval, by drawing groups of rows with replacement.

    Args:
        before: Sum of squares of every group, shape (m,).
        after: The same of the other model, shape (m,).

    Returns:
        The ratio after over before, and the interval.
    """
    ratios = []
    for seed in range(RESAMPLES // _AT_ONCE):
        drawn = integers(seed, len(before), (_AT_ONCE, len(before)))
        ratios.append(np.sqrt(after[drawn].sum(axis=1) / before[drawn].sum(axis=1)))
    low, high = np.quantile(np.concatenate(ratios), [0.025, 0.975])
    return float(np.sqrt(after.sum() / before.sum())), (float(low), float(high))
