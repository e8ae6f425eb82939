"""The thesis' formulas where they are exact: one joint turns, nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.thesis import formulas as f


def test_spring_by_hand():
    # 100 N on 2 m is 200 N m; 1 mm seen at 0.5 m is 2 mrad: 100 kN m/rad.
    assert f.stiffness_from_length(100.0, 2.0, 0.5, 1e-3) == pytest.approx(1e5)
    assert f.stiffness_from_rotation(100.0, 2.0, 2e-3) == pytest.approx(1e5)


def test_length_takes_a_known_joint_off():
    assert f.displacement_length([1, 2, 3], [1, 2, 0]) == pytest.approx(3.0)
    assert f.displacement_length([1, 2, 3], [1, 2, 0], [0, 0, 3]) == pytest.approx(0.0)


def test_joint_displacement_is_the_transposed_jacobian(kinematics):
    """Virtual work: the force's work on the displacement is the torque squared over the stiffness."""
    J = kinematics.jacobian(np.array([0.1, 0.2, -0.3, 0.4, 0.5, 0.6]), (0, 0, 0.18))
    force = np.array([10.0, -20.0, 30.0, 0, 0, 0])
    for joint in range(1, 7):
        d = f.joint_displacement(J, force, joint, 1e5)
        torque = float(J[:3, joint - 1] @ force[:3])
        assert float(d @ force[:3]) == pytest.approx(torque**2 / 1e5, abs=1e-15)


@pytest.mark.parametrize("theta", [1e-4, 2e-3])
def test_joint4_formula_sees_a_pure_rotation_of_joint_4(theta):
    """A stays, B turns about the axis of joint 4 at radius R4, and AB is square to B's motion."""
    A = np.array([0.5, 0.0, 2.055])
    B = np.array([0.5, 0.095, 2.055])  # same x: all of AB is the radius, as (3.15) assumes
    turn = Rotation.from_rotvec([theta, 0, 0])
    B_loaded = A + turn.apply(B - A)
    got = f.joint4_rotation((A, B), (A, B_loaded), 0.27, 0.095)
    assert got == pytest.approx(theta, rel=1e-3)


def test_joint4_formula_goes_wrong_when_joint_2_moves_puck_a():
    """A mere shift of both pucks, no joint turning between them, is read as a negative rotation (3.14)."""
    A, B = np.array([0.5, 0.0, 2.055]), np.array([0.5, 0.095, 2.055])
    shift = np.array([1.4e-4, 0.0, 0.0])
    got = f.joint4_rotation((A, B), (A + shift, B + shift), 0.27, 0.095)
    assert got == pytest.approx(-1.4e-4 / 0.27, rel=1e-3)


@pytest.mark.parametrize("theta", [5e-5, 6e-4])
def test_joint5_formula_sees_a_pure_rotation_of_joint_5(theta):
    A, B, C = np.array([0.32, 0, 1.855]), np.array([1.462, 0, 2.055]), np.array([1.869, 0, 1.967])
    C_loaded = B + Rotation.from_rotvec([0, theta, 0]).apply(C - B)
    got = f.joint5_rotation((A, B, C), (A, B, C_loaded))
    assert got == pytest.approx(theta, rel=1e-6)
