"""Friction that remembers: against a friction spring that is loaded step by step, and through a model."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.causes.joint_friction import JointFriction
from doormill_ros.robot_model.elastic.circumstances import NOTHING_KNOWN, Circumstances
from doormill_ros.robot_model.elastic.law.memory import FRICTIONS, Friction, let_through
from doormill_ros.robot_model.elastic.law.term import LawTerm
from doormill_ros.robot_model.elastic.load_case import build_load_case
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel, SizedCause
from doormill_ros.robot_model.law.term import SeenRange

ROBOT = load_robot("irb6600_175_255")
POINT = np.array([0.1, -0.05, 0.3])
JOINT = 3
Q = np.array([0.4, 0.2, -0.5, 0.3, 0.7, -0.2])


def loadings(n, seed=0, time=None, direction=None, dt=None):
    """n loadings of one posture, by forces of chance."""
    rng = np.random.default_rng(seed)
    return build_load_case(
        Kinematics(ROBOT.dh),
        np.tile(Q, (n, 1)),
        np.hstack([rng.normal(0.0, 300.0, (n, 3)), np.zeros((n, 3))]),
        POINT,
        direction=np.tile(np.ones(6) if direction is None else direction, (n, 1)),
        joint_stiffness=ROBOT.stiffness,
        circumstances=NOTHING_KNOWN if time is None else Circumstances(np.asarray(time, dtype=float), dt),
    )


def one_by_one(torques, **more):
    """Loadings of one posture whose torques about the joint are these [N m]."""
    case = loadings(len(torques), **more)
    torque = case.torque.copy()
    torque[:, JOINT] = torques
    return replace(case, torque=torque)


def step_by_step(torques, limit, side):
    """Turn of one friction spring at each load, in torques: it follows as soon as its friction is overcome."""
    at, turns = -0.5 * side * limit, []
    for torque in torques:
        before = at
        for way in (np.linspace(0.0, torque, 4001), np.linspace(torque, 0.0, 4001)):
            for now in way:
                if now - at > 0.5 * limit:
                    at = now - 0.5 * limit
                if at - now > 0.5 * limit:
                    at = now + 0.5 * limit
            if way[-1] == torque:
                turns.append(at - before)
    return np.array(turns)


@pytest.mark.parametrize("side", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("limit", [10.0, 40.0, 160.0])
def test_what_comes_through_is_that_of_a_friction_spring_loaded_step_by_step(side, limit):
    case = loadings(6, time=np.arange(6), direction=np.full(6, side))
    torque = case.torque[:, JOINT]
    assert np.abs(torque).min() < 10.0 < 40.0 < np.abs(torque).max()
    found = torque * let_through(case, JOINT, np.array([limit]))
    np.testing.assert_allclose(found, step_by_step(torque, limit, side), atol=1e-9)


def test_after_a_motion_it_holds_what_friction_is_said_to_hold():
    for side in (-1.0, 1.0):
        case = loadings(20, direction=np.full(6, side))
        cause, limit = JointFriction(f"joint {JOINT + 1}"), 20.0
        held = case.torque[:, JOINT] * (1.0 - let_through(case, JOINT, np.array([limit])))
        said = cause.hidden_state(case)[:, None] * cause.twist(
            case, cause.from_values(np.array([limit]), case)
        )
        expected = -(held / case.joint_stiffness[JOINT])[:, None] * case.joint_twist(JOINT)
        np.testing.assert_allclose(said, expected, atol=1e-15)
        assert 0 < np.count_nonzero(held) < 20


def test_loadings_count_in_the_order_of_the_clock_until_the_joints_move():
    limits, n = np.array([40.0]), 6
    torques = [30.0, 35.0, -25.0, 50.0, 45.0, -35.0]
    case = one_by_one(torques, time=np.arange(n))
    found, first = let_through(case, JOINT, limits), let_through(case, JOINT, limits, remembers=False)
    assert np.sum(np.abs(found - first) > 0.05) >= 2
    np.testing.assert_array_equal(let_through(one_by_one(torques), JOINT, limits), first)
    order = np.array([3, 0, 5, 1, 4, 2])
    shuffled = replace(
        case, torque=case.torque[order], circumstances=Circumstances(time=np.arange(n, dtype=float)[order])
    )
    np.testing.assert_array_equal(let_through(shuffled, JOINT, limits), found[order])
    # From the fourth loading on the joints came anew, by another angle or from another side.
    for moved in (
        replace(case, q=case.q + 0.1 * (np.arange(n) >= 3)[:, None] * np.eye(6)[1]),
        replace(
            case,
            direction=case.direction
            * np.where(np.arange(n) >= 3, -1.0, 1.0)[:, None] ** [[0, 1, 0, 0, 0, 0]],
        ),
    ):
        again = let_through(moved, JOINT, limits)
        np.testing.assert_array_equal(again[:3], found[:3])
        assert again[3] == first[3] != found[3]


def test_readings_that_share_a_loading_find_the_friction_alike():
    limits, torques = np.array([40.0]), [30.0, 35.0, -25.0, 50.0]
    # The load was on since 0.5 when the third was read.
    shared = one_by_one(torques, time=[0, 1, 2, 3], dt=np.array([0.5, 0.5, 1.5, 0.5]))
    third_first = one_by_one(torques, time=[0, 2, 1, 3], dt=np.full(4, 0.5))
    apart = one_by_one(torques, time=[0, 1, 2, 3], dt=np.full(4, 0.5))
    third = [let_through(case, JOINT, limits)[2] for case in (shared, third_first, apart)]
    assert third[0] == third[1] != third[2]
    same_time = one_by_one(torques, time=[0, 1, 1, 3])
    assert let_through(same_time, JOINT, limits)[2] == third[0]


def test_a_spring_behind_friction_is_softer_by_what_comes_through_on_a_path():
    friction, weight = Friction(56.0, False), 0.8
    assert FRICTIONS[friction.driver] == friction
    term = LawTerm("joint 4", "spring", friction.driver, "slope", (), SeenRange(0.0, 1.0, (0.5,)))
    wrench = np.array([300.0, -150.0, 200.0, 10.0, -20.0, 5.0])
    law = ExtendedComplianceModel(
        ROBOT.name, ROBOT.dh, ROBOT.stiffness, (), [SizedCause(term, np.array([weight]))]
    )
    case = build_load_case(
        Kinematics(ROBOT.dh), Q[None], wrench[None], POINT, joint_stiffness=ROBOT.stiffness
    )
    torque = float(case.torque[0, JOINT])
    assert abs(torque) > 56.0
    for side, held in ((np.sign(torque), 0.0), (-np.sign(torque), 56.0), (0.0, 28.0)):
        stiffness = ROBOT.stiffness.copy()
        stiffness[JOINT] /= 1.0 + weight * (1.0 - held / abs(torque))
        softer = ExtendedComplianceModel(ROBOT.name, ROBOT.dh, stiffness, ())
        direction = np.full(6, side)
        np.testing.assert_allclose(
            law.deflection(Q, wrench, POINT, direction), softer.deflection(Q, wrench, POINT), rtol=1e-9
        )


def test_many_elements_let_through_the_mean_of_what_each_does():
    case = loadings(8, time=np.arange(8))
    each = [
        Friction(limit, False).share(case, JOINT) for limit in (5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0)
    ]
    spread = let_through(case, JOINT, np.array([5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0]))
    np.testing.assert_allclose(spread, np.mean(each, axis=0), rtol=1e-12)
    np.testing.assert_allclose(Friction(80.0, True).share(case, JOINT), spread, rtol=1e-12)
