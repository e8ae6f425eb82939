"""The six loading tests of the thesis as load cases, and the lengths that a model predicts of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.causes.cause import DIRECTION, OWN_TORQUE, ElasticCause
from doormill_ros.robot_model.elastic.load_case import LoadCase, build_load_case
from doormill_ros.thesis.loading_tests import ThesisData, ThesisTest


def cases_of(data: ThesisData, stiffness: FloatArray, side: int) -> list[LoadCase]:
    """All tests, laws scaled by the largest torque of each joint in any of them: one friction torque for all.

    Args:
        data: The tests.
        stiffness: Of the joints, shape (6,) [N m / rad].
        side: 1 or -1: on which side of its link the reflector of test 6 sat.
    """
    cases = [_case(data, test, stiffness, side) for test in data.tests]
    largest = np.max([np.abs(case.torque[0]) for case in cases], axis=0)
    return [replace(case, largest_torque=largest) for case in cases]


def _case(data: ThesisData, test: ThesisTest, stiffness: FloatArray, side: int) -> LoadCase:
    kinematics = Kinematics(data.robot)
    reflector = test.reflector.copy()
    if test.joint == 6:
        reflector[1] *= side
    wrench = np.concatenate([test.force_base, test.moment_base])[None]
    case = build_load_case(
        kinematics,
        test.q[None],
        wrench,
        test.load_point if test.load_link == 6 else np.zeros(3),
        points=reflector[None],
        links=np.array([test.reflector_link]),
        direction=-np.ones((1, 6)),
        joint_stiffness=stiffness,
    )
    if test.load_link < 6:
        # A load on an inner link is felt by the joints before it only.
        moment = np.cross(load_point(data, test) - case.origin[0], test.force_base)[None]
        moment[0, test.load_link :] = 0.0
        case = replace(
            case, moment=moment, torque=np.einsum("nki,nki->nk", case.axes[:, :6, :, 2], moment[:, :6])
        )
    # All joints were pre-loaded: their last motion went against the load.
    return replace(case, direction=-np.sign(case.torque))


def predicted_lengths(
    data: ThesisData, cases: Sequence[LoadCase], cause: ElasticCause | None, theta: FloatArray
) -> FloatArray:
    """Predicted length of each test, shape (6,) [m]; test 4 is the rotation of joint 4 times its radius.

    Args:
        data: The tests.
        cases: Loads and geometry of each.
        cause: What acts besides the springs, None for nothing.
        theta: Its numbers, shape (p,).
    """
    lengths = []
    for case, test in zip(cases, data.tests, strict=True):
        twist = case.springs()[0]
        if cause is not None:
            twist = twist + cause.twist(case, theta)[0]
        if test.joint == 4:
            angle = case.torque[0, 3] / case.joint_stiffness[3]
            if cause is not None and cause.where == "joint 4" and cause.driver in (OWN_TORQUE, DIRECTION):
                unit = case.joint_twist(3)[0]
                angle += float(cause.twist(case, theta)[0] @ unit / (unit @ unit))
            lengths.append(abs(angle) * test.extra["radius"])
        else:
            lengths.append(float(np.linalg.norm(twist[:3])))
    return np.array(lengths)


def own_joint_length(data: ThesisData, case: LoadCase, test: ThesisTest, stiffness: FloatArray) -> float:
    """Length of a test with the joint under test giving way alone [m]; stiffness of shape (6,) [N m / rad]."""
    k = test.joint - 1
    angle = float(case.torque[0, k] / stiffness[k])
    lever = test.extra["radius"] if test.joint == 4 else float(np.linalg.norm(case.joint_twist(k)[0, :3]))
    return abs(angle) * lever


def load_point(data: ThesisData, test: ThesisTest) -> FloatArray:
    """Where the load of a test acts, base frame, shape (3,) [m]."""
    frame = Kinematics(data.robot).link_frames(test.q)[test.load_link]
    point: FloatArray = frame[:3, :3] @ test.load_point + frame[:3, 3]
    return point
