"""Contradictions between printed displacements, measured and simulated."""

from __future__ import annotations

import numpy as np

from doormill_ros.measurements.loading import displacement_per_compliance
from doormill_ros.thesis.contradiction import Contradiction, Evidence, um
from doormill_ros.thesis.recovery import repeatability
from doormill_ros.units import UM, m_to_um


def _simulated_lengths(c: Evidence) -> Contradiction:
    one, two = c.components(1), c.components(2)
    table = c.data.table_4_2["deviation_um"] * UM
    m1, m2 = c.data.test(1).measured, c.data.test(2).measured
    s1, s2 = c.data.test(1).simulated, c.data.test(2).simulated
    return Contradiction(
        "simulated displacement of tests 1 and 2",
        "table 4.2; A.8, A.9",
        f"the components give {um(one)} and {um(two)}, the table prints {um(s1)} and {um(s2)}; its "
        f"deviations {um(table[0])} and {um(table[1])} follow from the components ({um(abs(one - m1))}, "
        f"{um(abs(two - m2))}), not from the table ({um(abs(s1 - m1))}, {um(abs(s2 - m2))})",
        {"component_length_1": one, "component_length_2": two},
    )


def _circular(c: Evidence) -> Contradiction:
    one = c.components(1) / c.data.test(1).measured
    two = c.components(2) / c.data.test(2).measured
    return Contradiction(
        "agreement of tests 1 and 2",
        "table 4.2; chapters 4 and 5",
        "the stiffness was computed from the displacement it is then said to reproduce; one spring and the "
        f"same load must give it back, the simulation gives {one:.4f} and {two:.4f} of it, and this "
        "validates nothing",
        {"simulated_over_measured_1": one, "simulated_over_measured_2": two},
    )


def _simulation_of_test_3(c: Evidence) -> Contradiction:
    test = c.data.test(3)
    x, _, z = np.abs(test.simulated_components)
    J = c.kinematics.link_jacobian(test.q, test.reflector_link, test.reflector)[:3]
    alone = abs(J[0, 2] / J[2, 2])
    both = c.data.loadings(repeatability(c.data))
    d = displacement_per_compliance(c.kinematics, both)[2] @ (1.0 / c.recovery.stiffness)
    length = (
        abs(test.wrench_flange[2]) * test.load_arm * float(np.hypot(1.054, 0.207)) / c.recovery.stiffness[2]
    )
    return Contradiction(
        "simulated displacement of test 3",
        "table 4.2; A.10",
        f"its direction (x/z {x / z:.4f}) is that of joint 3 alone ({alone:.4f}), not of all joints "
        f"({abs(d[0] / d[2]):.4f}), while the measured column is the whole displacement; after taking joint "
        f"2 off, table 4.1 leaves {um(length)} and the deviation is {um(c.components(3) - length)}, not "
        f"{c.data.table_4_2['deviation_um'][2]:.1f} um",
        {
            "direction_simulated": x / z,
            "direction_joint_3": alone,
            "direction_all": abs(d[0] / d[2]),
            "corrected_length": length,
            "corrected_deviation": c.components(3) - length,
        },
    )


def _test_3_lengths(c: Evidence) -> Contradiction:
    loadings = c.data.loadings(repeatability(c.data))
    A = displacement_per_compliance(c.kinematics, loadings)[2]
    predicted = float(np.linalg.norm(A @ (1.0 / c.recovery.stiffness)))
    measured = c.data.test(3).measured
    return Contradiction(
        "stiffness and displacement of test 3",
        "tables 4.1, 4.2; A.10",
        f"with joints 2 and 3 as soft as table 4.1 has them the reflector moves {um(predicted)}, table 4.2 "
        f"prints {um(measured)}: {(predicted - measured) / repeatability(c.data):.0f} standard deviations "
        "of a repetition",
        {"predicted": predicted, "measured": measured},
    )


def _joint_5_in_test_3(c: Evidence) -> Contradiction:
    A = displacement_per_compliance(c.kinematics, c.data.loadings(repeatability(c.data)))[2]
    share = float(np.linalg.norm(A[:, 4])) / c.recovery.stiffness[4]
    deviation = c.data.table_4_2["deviation_um"][2] * UM
    return Contradiction(
        "cause of test 3's deviation",
        "chapter 5; sections 3.1.3, table 4.1",
        f"chapter 5 blames joint 5 for {um(deviation)}, but the load hangs along the flange axis through the "
        f"wrist: joint 5 adds {um(share)}",
        {"joint_5": share, "deviation": deviation},
    )


def _compared_length_6(c: Evidence) -> Contradiction:
    test = c.data.test(6)
    corrected = abs(test.wrench_flange[5]) * test.extra["radius"] / c.recovery.stiffness[5]
    ratio = abs(test.wrench_flange[5]) * test.extra["radius"] / test.measured / c.recovery.stiffness[0]
    return Contradiction(
        "measured displacement of test 6",
        "tables 4.1, 4.2; A.13",
        f"table 4.1 follows from {um(corrected)} (joint 1 taken off), table 4.2 prints {um(test.measured)} "
        f"(not taken off; it would make the ratio {ratio:.4f} instead of {c.data.ratios[5]:.4f}); like "
        f"against like the deviation is {um(corrected - test.simulated)}, not "
        f"{c.data.table_4_2['deviation_um'][5]:.1f} um",
        {
            "corrected_length": corrected,
            "ratio_from_table_4_2": ratio,
            "corrected_deviation": corrected - test.simulated,
        },
    )


def _simulated_rotation_4(c: Evidence) -> Contradiction:
    test = c.data.test(4)
    alone = test.load_arm * c.recovery.load_4_implied / c.recovery.stiffness[3]
    return Contradiction(
        "simulated rotation of test 4",
        "A.11; table 4.1",
        f"0.0002677 rad is {test.extra['simulated_rotation'] / alone:.3f} of what the spring of table 4.1 "
        f"gives ({m_to_um(alone):.1f} urad), although it is called the rotation of joint 4 in a simulation "
        "with that spring",
        {"ratio": test.extra["simulated_rotation"] / alone},
    )


def _normalization(c: Evidence) -> Contradiction:
    values = c.data.table_4_3["preloaded"]
    return Contradiction(
        "highest stiffness",
        "tables 4.1, 4.3; chapter 4",
        "both tables are normalized to the highest stiffness of the study, joint 1, yet the same joint "
        f"repeated reads {values[0]:.3f} and {values[1]:.3f}; three pre-loaded tests scatter by "
        f"{um(repeatability(c.data))} ({repeatability(c.data) / c.data.test(1).measured:.0%}) while table "
        "4.2 calls 0.5 um a deviation",
        {"repeatability": repeatability(c.data), "largest": float(values.max())},
    )


RULES = (
    _simulated_lengths,
    _circular,
    _simulation_of_test_3,
    _test_3_lengths,
    _joint_5_in_test_3,
    _compared_length_6,
    _simulated_rotation_4,
    _normalization,
)
