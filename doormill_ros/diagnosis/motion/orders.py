"""Finds waves over the angle in what is left over."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from scipy.ndimage import uniform_filter1d

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.ranking import first_largest
from doormill_ros.diagnosis.motion.model import JointFit
from doormill_ros.diagnosis.motion.problem import JointProblem
from doormill_ros.robot_model.motion.causes.joint_periodic_error import (
    FINE,
    JOINT_ORDERS,
    MOTOR_ORDERS,
    MotionPeriodicError,
)

_BINS = 1 << 16  #: of four turns; waves of up to a fifth of a bin's reach are read
_TURNS = 4
_HIGHEST = 2600.0  #: waves a turn of the joint
_FOUND = 2  #: orders that are tried, of what is slow and of what is quick
_FINER = 0.25  #: step between tried orders
_QUICK = 25  #: samples whose mean is slow
_BESIDE = 4  #: steps to either side of an order within which others are held against it


def wave_candidates(problem: JointProblem, found: JointFit) -> list[MotionPeriodicError]:
    """The orders that the residual of a fit asks for most, in every reading of them."""
    reach = max(float(np.ptp(motion.motor)) for motion in problem.motions)
    if reach * FINE < 2.0 * np.pi:
        return []
    lowest, width = max(FINE, 4.0 * np.pi / reach), 2.0 * np.pi / reach
    # Whole orders beyond the usual ones, below those of a fine scale, have one phase as these have.
    coarse = _liked_best(problem, found, np.arange(JOINT_ORDERS[-1] + 1.0, FINE))
    candidates = [MotionPeriodicError(problem.where, coarse)]
    for quick in (False, True):
        power = spectrum(problem, found.residual, quick)
        orders = np.arange(len(power)) / _TURNS
        usable = (orders >= lowest) & (orders <= _HIGHEST)
        for _ in range(_FOUND):
            peak = float(orders[first_largest(np.where(usable, power, 0.0))])
            order = _refined(problem, found, peak, width)
            usable &= np.abs(orders - peak) > width
            candidates += _readings(problem, order, width)
    return candidates


def neighbours(wave: MotionPeriodicError) -> list[MotionPeriodicError]:
    """Waves of the orders beside that of a wave over the joint's angle: few turns do not tell them apart."""
    if wave.angle != "joint":
        return []
    step = 1.0 if wave.order < FINE else _FINER
    orders = [
        wave.order + step * k for k in range(-_BESIDE, _BESIDE + 1) if k and wave.order + step * k > 0.0
    ]
    return [MotionPeriodicError(wave.where, order, "joint", wave.free, wave.smoothed) for order in orders]


def outermost(wave: MotionPeriodicError, others: Iterable[MotionPeriodicError]) -> list[MotionPeriodicError]:
    """Of orders that would do as well as a wave's, those to tell: of a fine scale the ends of what is near alone."""
    others = list(others)
    near = [
        one
        for one in others
        if wave.order >= FINE and one.angle == wave.angle and abs(one.order - wave.order) <= _BESIDE * _FINER
    ]
    low = [one for one in near if one.order < wave.order]
    high = [one for one in near if one.order > wave.order]
    ends = [end(part, key=lambda one: one.order) for end, part in ((min, low), (max, high)) if part]
    return [*ends, *(one for one in others if all(one is not other for other in near))]


def spectrum(problem: JointProblem, residual: FloatArray, quick: bool = False) -> FloatArray:
    """Power of waves over the joint's angle summed over the recordings, a quarter order apart.

    Args:
        problem: The joint.
        residual: Shape (n,).
        quick: Of what changes quickly in time alone: what is slow leaks into all orders.

    Returns:
        Shape (bins / 2 + 1,).
    """
    power = np.zeros(_BINS // 2 + 1)
    for i, motion in enumerate(problem.motions):
        own = residual[problem.recording == i]
        if quick:
            own = own - uniform_filter1d(own, _QUICK, mode="nearest")
        own = own * problem.kept[problem.recording == i]
        place = np.round(motion.motor / (2.0 * np.pi * _TURNS) * _BINS).astype(int) % _BINS
        power += np.abs(np.fft.rfft(np.bincount(place, weights=own, minlength=_BINS))) ** 2
    return power


def _readings(problem: JointProblem, order: float, width: float) -> Sequence[MotionPeriodicError]:
    """An order of the joint and the motor's that is as near as the data tell; a lone recording has its own phase."""
    angles = [(order, "joint")]
    for multiple in MOTOR_ORDERS:
        if abs(multiple * problem.motions[0].gear_ratio - order) < 0.5 * width:
            angles.append((float(multiple), "motor"))
    return [
        MotionPeriodicError(problem.where, waves, angle, free, smoothed)
        for waves, angle in angles
        for free in ((False, True) if len(problem.motions) > 1 else (True,))
        for smoothed in (False, True)
    ]


def _refined(problem: JointProblem, found: JointFit, peak: float, width: float) -> float:
    """The order near a peak that the data like best."""
    tried = np.arange(np.ceil(peak - 0.5 * width), peak + 0.5 * width + 1e-9, _FINER)
    return _liked_best(problem, found, tried) if len(tried) else peak


def _liked_best(problem: JointProblem, found: JointFit, tried: FloatArray) -> float:
    """Of some orders, shape (m,), the one that takes most from what a fit leaves, each recording with its own phase."""
    falls: list[float] = []
    for order in tried:
        fall = 0.0
        for i, seen in enumerate(problem.seen(found.delay)):
            rows = problem.recording == i
            kept = problem.kept[rows] & seen.recorded
            wave = (
                np.column_stack(
                    [MotionPeriodicError(problem.where, float(order)).wave(seen), np.ones(rows.sum())]
                )
                * kept[:, None]
            )
            own = found.residual[rows] * kept
            right = wave.T @ own
            fall += float(right @ np.linalg.solve(wave.T @ wave + 1e-9 * np.eye(3), right))
        falls.append(fall)
    return float(tried[first_largest(np.array(falls))])
