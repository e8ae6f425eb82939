"""What is noise in a recording: slips of the reading, its size, and what chance gives a shape."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.ndimage import uniform_filter1d

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.robot_model.motion.quiet_torque import white_noise
from doormill_ros.robot_model.motion.view import JointMotion

#: Deviations from its neighbours on either side by which a sample is a slip of the reading; at most this share of them.
_GROSS, _GROSS_SHARE, _BESIDE = 20.0, 0.05, 5
_WITHIN = 1.96  #: deviations within which all but that share of normal noise is
_ALIKE = 9  #: frequencies, half a wave a recording apart, whose powers are averaged


def no_slips(motion: JointMotion) -> BoolArray:
    """Samples of a recording that are no slips of the reading, shape (n,)."""
    away = np.abs(_from_neighbours(motion.time, motion.link - motion.motor))
    # What nearly all samples keep within: where a joint rests half of them may lie on the line exactly.
    scale = float(np.quantile(away, 1.0 - _GROSS_SHARE)) / _WITHIN
    slip = away > _GROSS * max(scale, 1e-9)
    return ~slip if slip.mean() < _GROSS_SHARE else np.ones(len(away), dtype=bool)


def _from_neighbours(time: FloatArray, values: FloatArray) -> FloatArray:
    """By how much each of a row of values, shape (n,), is off a line through its neighbours, which few can turn."""
    near, when = (
        sliding_window_view(np.pad(row, _BESIDE, mode="reflect", reflect_type="odd"), 2 * _BESIDE + 1)
        for row in (values, time)
    )
    before, after = np.arange(_BESIDE)[::-1], np.arange(_BESIDE + 1, 2 * _BESIDE + 1)
    slope = np.median(
        (near[:, after] - near[:, before]) / (when[:, after] - when[:, before]), axis=1, keepdims=True
    )
    return np.asarray(values - np.median(near - slope * (when - time[:, None]), axis=1), dtype=float)


def mean_square_of(errors: FloatArray) -> float:
    """Of the samples that count, of shape (n,) [rad^2]: slips, and what lies beyond the ends, are exactly 0."""
    return float(np.sum(errors**2)) / max(int(np.count_nonzero(errors)), 1)


def size_of(errors: FloatArray) -> float:
    """Root mean square of the samples that count, as of `mean_square_of` [rad]."""
    return float(np.sqrt(mean_square_of(errors)))


def noise_floor(
    motions: Sequence[JointMotion], noise: tuple[float | None, float | None, float | None]
) -> float:
    """Noise of the difference between encoders and spring: stated, or read from neighbours [rad].

    Args:
        motions: Recordings of one joint.
        noise: Standard deviation of link, motor [rad] and torque [N m]; None where not stated.
    """
    link, motor, torque = noise
    # Third differences see nothing of what a filter left.
    left = max((motion.torque_noise or 0.0) / motion.stiffness for motion in motions)
    if link is not None:
        by_torque = left or (torque or 0.0) / motions[0].stiffness
        return float(np.sqrt(link**2 + (motor or 0.0) ** 2 + by_torque**2))
    near = max(
        white_noise(motion.link - motion.motor + motion.torque / motion.stiffness) for motion in motions
    )
    return float(np.hypot(near, left))


def chance_of(errors: Sequence[FloatArray], shapes: Sequence[FloatArray]) -> float:
    """Expected square of the projection of errors on a shape: what they have at the frequencies that it is made of.

    Neighbouring samples repeat each other: to slow shapes a recording is a few independent samples, to fast ones
    many.

    Args:
        errors: What a model leaves of each recording, shape (n,) each.
        shapes: Effect in question, the same.
    """
    total, power = 0.0, 0.0
    for own, wanted in zip(errors, shapes, strict=True):
        length = len(own)
        theirs = np.abs(np.fft.rfft(own, 2 * length)) ** 2 / length
        mine = np.abs(np.fft.rfft(wanted, 2 * length)) ** 2
        # A fit has taken out of the errors what is just like the shape: neighbouring frequencies tell the rest.
        total += float(np.sum(uniform_filter1d(theirs, _ALIKE, mode="nearest") * mine))
        power += float(np.sum(mine))
    return total / max(power, 1e-300)
