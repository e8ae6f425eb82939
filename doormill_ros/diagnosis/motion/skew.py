"""Whether the link encoders are late together or one by one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from doormill_ros.diagnosis.motion.model import JointFit
from doormill_ros.robot_model.motion.causes.cause import DELAY, MotionCause
from doormill_ros.robot_model.motion.causes.joint_damping import JointDamping
from doormill_ros.robot_model.motion.causes.time_skew import TimeSkew

#: Delays are alike that differ by no more than so many standard deviations, or by this share.
_ALIKE, _SHARE = 4.0, 0.05


def alike(cause: MotionCause, late: float) -> MotionCause | None:
    """What no recording tells from a cause of a joint that is seen so late [s]: an early encoder looks like damping.

    They differ by the acceleration's share alone, which no recording shows.
    """
    if isinstance(cause, JointDamping):
        return TimeSkew(cause.where)
    return JointDamping(cause.where) if isinstance(cause, TimeSkew) and late < 0.0 else None


def without_delays(fit: JointFit) -> list[MotionCause]:
    """Members of a fit that neither a common skew nor what it leaves can stand for."""
    return [cause for cause in fit.members if cause.acts_on != DELAY]


def own_skews(fits: Sequence[JointFit]) -> dict[int, tuple[float, float]]:
    """Skew and its standard deviation [s] of every joint that has one, by its index; negative for what looks damped."""
    found = {}
    for index, fit in enumerate(fits):
        for kind, delay, sign in ((TimeSkew, fit.delay, 1.0), (JointDamping, 0.0, -1.0)):
            at = fit.of(kind)
            if at is not None:
                found[index] = (delay + sign * float(fit.x[at][0]), float(fit.std[at][0]))
                break
    return found


def common_skew(
    skews: Mapping[int, tuple[float, float]],
    joints: int,
    asked: Callable[[int], tuple[float, float]],
) -> tuple[float, float, list[int]]:
    """The skew that most joints share, if two or more agree and no other has none.

    A further joint may seem less late, which damping does; one clock is behind all encoders or none of them.

    Args:
        skews: Skew and standard deviation of joints that have one, by index [s].
        joints: How many there are.
        asked: Skew and standard deviation of a joint in whose model it did not earn its place.

    Returns:
        The skew, its standard deviation, and who agrees; nobody where encoders are late one by one.
    """
    if len(skews) < 2:
        return 0.0, 0.0, []
    silent = {index: asked(index) for index in range(joints) if index not in skews}
    best: tuple[float, float, list[int]] = (0.0, 0.0, [])
    for centre, spread in skews.values():
        agree = [
            index
            for index, (value, std) in sorted(skews.items())
            if abs(value - centre) <= max(_ALIKE * float(np.hypot(std, spread)), _SHARE * abs(centre))
        ]
        weight = np.array([1.0 / max(skews[index][1], 1e-9) ** 2 for index in agree])
        told = np.array([skews[index][0] for index in agree])
        mean = float(weight @ told / weight.sum())
        if (len(agree), mean) > (len(best[2]), best[0]):
            # Joints that agree by less than they say know it that much less (Birge, Phys. Rev. 40 (1932) 207).
            apart = float(weight @ (told - mean) ** 2) / max(len(agree) - 1, 1)
            best = (mean, float(np.sqrt(max(1.0, apart) / weight.sum())), agree)
    mean, std, agree = best
    for value, spread in silent.values():
        if abs(value - mean) > _ALIKE * float(np.hypot(std, spread)):
            return 0.0, 0.0, []
    others = [value for index, (value, _) in skews.items() if index not in agree]
    if len(agree) < 2 or any(value > mean for value in others):
        return 0.0, 0.0, []
    return round(mean, 7), std, agree
