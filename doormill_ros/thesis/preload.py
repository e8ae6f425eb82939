"""Table 4.3: joint 1 identified again, pre-loaded and not; read as a gap and as friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.distributions import student_ppf
from doormill_ros.thesis.loading_tests import ThesisData
from doormill_ros.thesis.recovery import recover


@dataclass(frozen=True)
class PreloadReading:
    """Table 4.3 read as one effect of joint 1.

    Attributes:
        gap, gap_std, gap_ci95: Read as a gap that pre-loading closes [rad].
        friction, friction_std: Read as friction that carries load when pre-loaded [N m].
        stiffness_if_friction: Spring of the joint in the second reading [N m / rad].
        torque: Torque of the test [N m].
        readings: How many pre-loaded and not pre-loaded values there are.
    """

    gap: float
    gap_std: float
    gap_ci95: tuple[float, float]
    friction: float
    friction_std: float
    stiffness_if_friction: float
    torque: float
    readings: tuple[int, int]


def read_preload_test(data: ThesisData) -> PreloadReading:
    """Estimate what the four values of table 4.3, and the 1.0 of table 4.1, say about joint 1.

    A stiffness is torque over angle, so each value is an angle under the same torque. The scatter
    within pre-loaded and within not pre-loaded values is the only measure of uncertainty there is:
    three degrees of freedom.
    """
    one = data.test(1)
    stiffness = float(recover(data).stiffness[0])
    torque = abs(float(one.wrench_flange[1])) * one.load_arm
    closed = torque / stiffness / np.concatenate([[1.0], data.table_4_3["preloaded"]])
    open_ = torque / stiffness / data.table_4_3["not_preloaded"]
    freedom = len(closed) + len(open_) - 2
    spread = np.sum((closed - closed.mean()) ** 2) + np.sum((open_ - open_.mean()) ** 2)
    std = float(np.sqrt(spread / freedom * (1.0 / len(closed) + 1.0 / len(open_))))
    gap = float(open_.mean() - closed.mean())
    half = student_ppf(0.975, freedom) * std
    soft = torque / float(open_.mean())
    return PreloadReading(
        gap=gap,
        gap_std=std,
        gap_ci95=(gap - half, gap + half),
        friction=gap * soft,
        friction_std=std * soft,
        stiffness_if_friction=soft,
        torque=torque,
        readings=(len(closed), len(open_)),
    )
