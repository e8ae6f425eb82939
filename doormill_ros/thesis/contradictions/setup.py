"""Contradictions about loads, arms and postures."""

from __future__ import annotations

import numpy as np

from doormill_ros.thesis.contradictions.finding import Contradiction, Evidence
from doormill_ros.thesis.loading_tests import GRAVITY
from doormill_ros.units import DEG


def _signs_of_test_4(c: Evidence) -> Contradiction:
    down = {}
    for name, q4, q5 in (("section 3.1", 90.0, -90.0), ("section 3.1.4", -90.0, 90.0)):
        R = c.kinematics.forward(np.array([0.0, 0.0, 0.0, q4, q5, 90.0]) * DEG)[:3, :3]
        # Flange x component of a weight, as a share of it.
        down[name] = float(R[:, 0] @ [0.0, 0.0, -1.0])
    return Contradiction(
        "posture of test 4",
        "section 3.1 against 3.1.4; A.11",
        f"q4, q5 = +90, -90 degrees or -90, +90: a hanging weight reads {down['section 3.1']:+.0f} of "
        f"itself along flange x in the first and {down['section 3.1.4']:+.0f} in the second; K4 = Fx L1 / "
        "theta is positive in the second only, so 3.1.4 holds",
        {"fx_share_3_1": down["section 3.1"], "fx_share_3_1_4": down["section 3.1.4"]},
    )


def _load_arms(c: Evidence) -> Contradiction:
    one, five, six = (c.data.test(k).wrench_flange for k in (1, 5, 6))
    arm = {1: -one[3] / one[1], 5: five[4] / five[0], 6: six[4] / six[0]}
    return Contradiction(
        "arm of the load in tests 1, 5 and 6",
        "A.8, A.12, A.13",
        "all take the load 180 mm in front of the flange, yet moment over force puts it "
        f"{arm[1] * 1e3:.0f}, {arm[5] * 1e3:.0f} and {arm[6] * 1e3:.0f} mm from the sensor; with one and "
        "the same sensor at most one arm is right, and if test 1's is, joint 5 was loaded "
        f"{(arm[5] - arm[1]) / 0.38:+.1%}",
        {"arm_1": arm[1], "arm_5": arm[5], "arm_6": arm[6]},
    )


def _pulley(c: Evidence) -> Contradiction:
    weight = c.data.load_mass * GRAVITY
    force = {k: float(np.linalg.norm(c.data.test(k).wrench_flange[:3])) for k in (1, 3, 5, 6)}
    return Contradiction(
        "load of test 2",
        "sections 3.1, 3.1.2; A.9",
        f"one weight of {weight:.1f} N reads {force[3]:.1f} and {force[5]:.1f} N hanging (tests 3, 5) but "
        f"{force[1]:.1f} and {force[6]:.1f} N over the pulley (tests 1, 6); test 2 pulls over the pulley, "
        "past the sensor, and takes 197 N: with the pulley's loss joint 2 is "
        f"{(force[1] + force[6]) / 2 / 197 - 1:+.1%}",
        {"weight": weight, **{f"force_{k}": value for k, value in force.items()}},
    )


RULES = (
    _signs_of_test_4,
    _load_arms,
    _pulley,
)
