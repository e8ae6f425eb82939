"""Noise of several series that were measured by different means: what it leaves altogether, and who counts how much."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.measurements.sets.pose_set import PoseSet
from doormill_ros.statistics import median_length


def common_noise(sets: Sequence[PoseSet]) -> FloatArray:
    """Root mean square over all rows of the noise per axis, position [m] and rotation [rad], shape (2,)."""
    noise = np.array([data.noise for data in sets])
    # In shares of the largest: of equal ones the mean is that one to the last digit.
    largest = noise.max(axis=0)
    mean = np.average((noise / largest) ** 2, axis=0, weights=[len(data) for data in sets])
    result: FloatArray = largest * np.sqrt(mean)
    return result


def evening(sets: Sequence[PoseSet]) -> list[FloatArray]:
    """Factors that bring the components of every series' errors to the common noise, shape (6,) each.

    So errors of a good tracker are not lost beside the noise of a bad one; with equal noise all factors are 1.
    """
    common = common_noise(sets)
    return [np.repeat(common / np.array(data.noise), 3) for data in sets]


def evened(sets: Sequence[PoseSet], errors: Sequence[FloatArray]) -> list[FloatArray]:
    """Errors of the rows of every series, shape (n, 6) each, brought to the common noise."""
    return [error * factor for error, factor in zip(errors, evening(sets), strict=True)]


def left_over(sets: Sequence[PoseSet], errors: Sequence[FloatArray]) -> list[tuple[float, float]]:
    """Standard deviation per axis of every series' errors, shape (n, 6), position [m] and rotation [rad].

    Series of the same noise have it in common; it is no less than that.
    """
    found = np.array([data.noise for data in sets])
    for axis, part in enumerate((slice(0, 3), slice(3, 6))):
        for noise in dict.fromkeys(data.noise[axis] for data in sets):
            alike = [i for i, data in enumerate(sets) if data.noise[axis] == noise]
            seen = [errors[i][:, part] for i in alike if axis == 0 or sets[i].oriented]
            if seen:
                length = float(np.median(np.linalg.norm(np.concatenate(seen), axis=1)))
                found[alike, axis] = max(length / median_length(3), noise)
    return [(float(position), float(rotation)) for position, rotation in found]


def expected(
    data: PoseSet, sets: Sequence[PoseSet], sigmas: Sequence[tuple[float, float]]
) -> tuple[float, float]:
    """Standard deviation per axis of errors of another set, position [m] and rotation [rad].

    Args:
        data: The other set.
        sets: Series with known ones, of which that with the most similar noise is taken, at least the set's own.
        sigmas: Of theirs.
    """
    ratio = [abs(float(np.log(one.noise[0] / data.noise[0]))) for one in sets]
    position, rotation = sigmas[ratio.index(min(ratio))]
    return max(position, data.noise[0]), max(rotation, data.noise[1])
