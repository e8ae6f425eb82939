"""The simulated truth against the thesis, beam theory and laws that every elastic body obeys."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.simulation.truth.elasticity import cantilever
from doormill_ros.simulation.truth.robot import TruthRobot

HALF = np.pi / 2
DH = np.array(
    [
        [0.0, 0.780, 0.320, -HALF],
        [-HALF, 0.0, 1.075, 0.0],
        [0.0, 0.0, 0.200, -HALF],
        [0.0, 1.142, 0.0, HALF],
        [0.0, 0.0, 0.0, -HALF],
        [np.pi, 0.200, 0.0, 0.0],
    ]
)
LOAD_POINT = np.array([0.0, 0.0, 0.18])


def effect(cause, where, **parameters):
    return {"cause": cause, "where": where, "parameters": parameters}


def test_home_pose_is_that_of_appendix_a2():
    T = TruthRobot(DH).forward(np.zeros((1, 6)))[0]
    np.testing.assert_allclose(T[:3, 3], [1.662, 0.0, 2.055], atol=1e-12)
    np.testing.assert_allclose(T[:3, :3], [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], atol=1e-12)


def test_own_kinematics_agree_with_the_robot_package():
    q = np.random.default_rng(0).uniform(-2.0, 2.0, (200, 6))
    robot = load_robot("irb6600_175_255")
    np.testing.assert_allclose(
        TruthRobot(robot.dh).link_frames(q), Kinematics(robot).link_frames(q), atol=1e-12
    )


def test_joint_1_test_of_the_thesis_gives_its_measured_displacement():
    # A.8: 176 N across at 1.842 m; table 4.2: 65.7 um at sqrt(120^2 + 480^2) mm from the axis.
    robot = TruthRobot(DH)
    wrench = np.array([[0.0, 176.0, 0.0, 0.0, 0.0, 0.0]])
    loaded = robot.deflected_frames(np.zeros((1, 6)), wrench, LOAD_POINT)[0, 1]
    still = robot.link_frames(np.zeros((1, 6)))[0, 1]
    turned = loaded[:3, :3] @ still[:3, :3].T
    angle = np.arctan2(turned[1, 0], turned[0, 0])
    assert angle * np.hypot(0.120, 0.480) == pytest.approx(65.7e-6, rel=0.002)


LINEAR = [
    effect("joint_cross_compliance", "joint 2", compliance=2e-7),
    effect("link_bending", "link 2", EI=2e6),
    effect("link_bending", "link 4", EI=1e6),
    effect("link_torsion", "link 3", GJ=1e6),
    effect("base_compliance", "base", stiffness=2e7),
    effect("tool_compliance", "flange", stiffness=1e6),
    effect("joint_offset", "joint 3", angle=0.1),
]


def compliance_matrix(robot, q, load_point):
    """Twist of the load point per unit wrench, from very small loads."""
    size = 1e-3
    columns = []
    still = robot.forward(q[None])[0]
    for axis in np.eye(6):
        T = robot.deflected(q[None], size * axis[None], load_point)[0]
        shift = (T - still) @ np.append(load_point, 1.0)
        turn = T[:3, :3] @ still[:3, :3].T
        spin = np.array([turn[2, 1], turn[0, 2], turn[1, 0]])
        columns.append(np.concatenate([shift[:3], spin]) / size)
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("hidden", LINEAR, ids=lambda e: f"{e['cause']} {e['where']}")
def test_every_linear_effect_is_reciprocal_and_gives_way_to_the_load(hidden):
    # Maxwell-Betti: the compliance matrix of an elastic structure is symmetric and positive definite.
    robot = TruthRobot(DH, [hidden])
    for q in np.random.default_rng(1).uniform(-1.2, 1.2, (5, 6)):
        C = compliance_matrix(robot, q, LOAD_POINT)
        assert np.abs(C - C.T).max() < 1e-5 * np.abs(C).max()
        assert np.linalg.eigvalsh((C + C.T) / 2.0).min() > 0.0


def test_cantilever_agrees_with_the_integrated_beam_equation():
    length, bending, force, moment = 1.3, 1.0 / 2.5e5, 420.0, -95.0

    def beam(s, state):
        # Deflection v along y, slope v'; M(s) = moment + force (L - s), v'' = M / EI.
        return [state[1], bending * (moment + force * (length - s))]

    end = solve_ivp(beam, (0.0, length), [0.0, 0.0], rtol=1e-11, atol=1e-14).y[:, -1]
    tip, load, couple = (np.array([v]) for v in ([length, 0, 0], [30.0, force, 0], [5.0, 0, moment]))
    shift, turn = cantilever(bending, 0.0, tip, load, couple)
    np.testing.assert_allclose(shift[0], [0.0, end[0], 0.0], atol=1e-12)
    np.testing.assert_allclose(turn[0], [0.0, 0.0, end[1]], atol=1e-12)


def joint_1_angle(robot, torque, direction):
    """Angle of joint 1 under a pure couple about its axis."""
    q = np.array([[0.0, 0.3, -0.2, 0.4, 0.5, 0.1]])
    wrench = np.array([[0, 0, 0, 0, 0, torque]], dtype=float)
    a = np.full((1, 6), float(direction))
    T = robot.deflected_frames(q, wrench, LOAD_POINT, a)[0, 1] @ np.linalg.inv(robot.link_frames(q)[0, 1])
    return np.arctan2(T[1, 0], T[0, 0])


@pytest.mark.parametrize("torque", [-300.0, -20.0, 20.0, 300.0])
def test_backlash_opens_only_for_a_joint_that_moved_along_the_load(torque):
    robot = TruthRobot(DH, [effect("joint_backlash", "joint 1", gap=1e-4, crossing=40.0)])
    plain = TruthRobot(DH)
    along, against = np.sign(torque), -np.sign(torque)
    share = min(abs(torque) / 40.0, 1.0)
    spring = joint_1_angle(plain, torque, along)
    assert joint_1_angle(robot, torque, against) == pytest.approx(spring, abs=1e-12)
    assert joint_1_angle(robot, torque, along) == pytest.approx(spring + along * 1e-4 * share, abs=1e-9)
    assert joint_1_angle(robot, torque, 0) == pytest.approx(spring, abs=1e-12)


def test_hardening_is_the_secant_law():
    robot = TruthRobot(DH, [effect("joint_hardening", "joint 1", stiffness=1e6, hardening=2e-3)])
    assert joint_1_angle(robot, 500.0, 1) == pytest.approx(500.0 / (1e6 * (1 + 2e-3 * 500.0)), rel=1e-6)


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (effect("joint_backlash", "joint 7", gap=1e-4), "joint 7"),
        (effect("joint_backlash", "link 1", gap=1e-4), "link 1"),
        (effect("joint_backlash", "joint 1"), "gap"),
        (effect("gremlins", "joint 1", count=3), "gremlins"),
    ],
)
def test_impossible_effects_are_refused(bad, message):
    with pytest.raises(ValueError, match=message):
        TruthRobot(DH, [bad])


def test_wrong_table_is_refused():
    with pytest.raises(ValueError, match=r"\(5, 4\)"):
        TruthRobot(DH[:5])
