"""Contradictions between formulas, scripts and mechanics, and about loads, arms and postures."""

from __future__ import annotations

import numpy as np

from doormill_ros.measurements.loading import displacement_per_compliance
from doormill_ros.thesis.contradiction import Contradiction, Evidence, um
from doormill_ros.thesis.fit import joint1_of_a13
from doormill_ros.thesis.recovery import repeatability
from doormill_ros.units import DEG, GRAVITY, m_to_mm, m_to_um


def _frames_of_a13(c: Evidence) -> Contradiction:
    test = c.data.test(6)
    J = c.kinematics.jacobian(test.q, (0.0, 0.0, c.data.tool_z))
    wrong = float(J[:, 0] @ test.wrench_flange)
    right = float(J[:, 0] @ np.concatenate([test.force_base, test.moment_base]))
    taken = float(joint1_of_a13(c.kinematics, c.data, c.recovery)[1])
    true = float(J[1, 0] * right / c.recovery.stiffness[0])
    return Contradiction(
        "torque of joint 1 in test 6",
        "A.13 against equation 2.34",
        f"readings in flange axes meet a Jacobian in base axes: {wrong:.1f} N m where the load makes "
        f"{right:.1f} N m; {um(taken)} were taken off along y instead of {um(true)}",
        {"torque_script": wrong, "torque": right, "taken_off": taken, "to_take_off": true},
    )


def _joint_5_in_test_6(c: Evidence) -> Contradiction:
    A = displacement_per_compliance(c.kinematics, c.data.loadings(repeatability(c.data)))[5]
    share = np.abs(A[0]) / c.recovery.stiffness
    return Contradiction(
        "joints that give way in test 6",
        "section 3.1.6; table 4.1",
        f"only joint 1 is taken off ({um(np.linalg.norm(A[:, 0]) / c.recovery.stiffness[0])}), yet the rope "
        f"pulls 380 mm below the wrist: joint 5 as soft as table 4.1 has it adds {um(share[4])} along x and "
        f"joint 2 {um(share[1])}, joint 6 itself {um(share[5])}",
        {"joint_5": float(share[4]), "joint_2": float(share[1]), "joint_6": float(share[5])},
    )


def _place_of_joint_2_in_test_3(c: Evidence) -> Contradiction:
    test = c.data.test(3)
    torque = abs(test.wrench_flange[2]) * test.load_arm
    tcp = c.kinematics.jacobian(test.q, (0, 0, c.data.tool_z))[:3, 1] * torque / c.recovery.stiffness[1]
    reflector = (
        c.kinematics.link_jacobian(test.q, 6, test.reflector)[:3, 1] * torque / c.recovery.stiffness[1]
    )
    off = float(np.linalg.norm(tcp - reflector))
    return Contradiction(
        "displacement taken off in test 3",
        "equation 3.6; A.10",
        f"joint 2's displacement is computed at the load point and taken off the reflector, {um(off)} from "
        "what it is there",
        {"difference": off},
    )


def _angle_of_test_5(c: Evidence) -> Contradiction:
    test = c.data.test(5)
    frames = c.kinematics.link_frames(test.q)
    joint2, joint3, joint5 = frames[1, :3, 3], frames[2, :3, 3], frames[4, :3, 3]
    along = (joint5 - joint3) @ (joint5 - joint2) / np.sum((joint5 - joint2) ** 2)
    share = 1.0 - float(along)
    torque = abs(test.wrench_flange[0]) * (test.load_arm + 1.142)
    theta = test.wrench_flange[0] * test.load_arm / c.recovery.stiffness[4]
    own = theta - share * torque / c.recovery.stiffness[2]
    return Contradiction(
        "angle of test 5",
        "section 3.1.5 against A.12",
        "the text takes pucks A, B, C next to the joint, the script the lines joint 2 to 5 and 5 to tool: "
        f"their angle holds {share:.3f} of joint 3's rotation, so joint 5 is {theta / own - 1:+.0%} stiffer "
        "than table 4.1",
        {"share_of_joint_3": share, "stiffness_factor": theta / own},
    )


def _alpha_of_test_4(c: Evidence) -> Contradiction:
    test = c.data.test(4)
    # A sits on the axis of joint 4, its distance L2 from joint 3.
    a = np.array([np.sqrt(test.extra["lever_L2"] ** 2 - 0.2**2), 0.0, 0.2])
    torque = c.data.load_mass * GRAVITY * 1.142
    turn2, turn3 = torque / c.recovery.stiffness[1:3]
    moved = np.array([(a[2] + 1.075) * turn2 + a[2] * turn3, 0.0, -a[0] * (turn2 + turn3)])
    alpha = float(np.arctan(np.linalg.norm(moved) / test.extra["lever_L2"]))
    true = float(turn2 + turn3)
    theta = test.measured / test.extra["radius"]
    return Contradiction(
        "angle taken off in test 4",
        "equations 3.14 to 3.16; tables 4.1, 4.2",
        "joint 2 moves puck A by its own lever of more than a metre, but 3.14 divides by 270 mm: it takes "
        f"{m_to_um(alpha):.0f} urad off where joints 2 and 3 turn {m_to_um(true):.0f} urad, about another axis "
        f"than joint 4, which turns {m_to_um(theta):.0f} urad",
        {"alpha": alpha, "rotation": true, "rotation_joint_4": theta},
    )


def _swapped_lengths(c: Evidence) -> Contradiction:
    right = float(c.kinematics.jacobian(np.zeros(6))[1, 0])
    # A.6 puts 0.780 into Tx and 0.320 into Tz.
    wrong = right - c.data.robot.dh[0, 2] + c.data.robot.dh[0, 1]
    return Contradiction(
        "lengths of the first link",
        "A.6, A.7, A.14, A.15 against table 2.1 and A.2",
        "0.780 and 0.320 m are exchanged in the printed Jacobian: joint 1 moves the home flange "
        f"{wrong:.3f} m per radian along y, table 2.1 gives {right:.3f}; columns 2 to 6 do not depend on it",
        {"printed": wrong, "table_2_1": right},
    )


def _misprints(c: Evidence) -> Contradiction:
    test = c.data.test(3)
    J = c.kinematics.jacobian(test.q, (0.0, 0.0, c.data.tool_z))
    wrench = np.concatenate([test.force_base, test.moment_base])
    printed, right = float((J @ wrench)[2]), float((J.T @ wrench)[2])
    return Contradiction(
        "torque equations",
        "equations 3.7, 3.8, 3.32, 3.33 against 2.34 and A.10",
        f"tau = J W is no torque (joint 3 of test 3: {printed:.1f} in no unit, J^T W is {right:.1f} N m), "
        "and the joint vectors of 3.7 and 3.32 have five elements for six joints",
        {"printed": printed, "torque": right},
    )


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
        f"{m_to_mm(arm[1]):.0f}, {m_to_mm(arm[5]):.0f} and {m_to_mm(arm[6]):.0f} mm from the sensor; with one and "
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
    _frames_of_a13,
    _joint_5_in_test_6,
    _place_of_joint_2_in_test_3,
    _angle_of_test_5,
    _alpha_of_test_4,
    _swapped_lengths,
    _misprints,
    _signs_of_test_4,
    _load_arms,
    _pulley,
)
