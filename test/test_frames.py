"""Displacements of many poses against scipy's matrix exponential, and wrenches by the work they do."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from doormill_ros.frames import (
    apply_twist,
    from_xyzw,
    quaternion_xyzw,
    rotate_wrench,
    rotation_from_vector,
    rotation_rpy,
    rotation_x,
    rotation_y,
    rotation_z,
    shift_wrench,
    twist_between,
    vector_from_rotation,
)

VECTORS = st.lists(st.floats(-1.7, 1.7), min_size=3, max_size=3)


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


@given(VECTORS, st.sampled_from([1.0, 1e-3, 1e-7, 0.0]))
def test_rotation_is_the_matrix_exponential(vector, scale):
    rotvec = scale * np.array(vector)
    assert rotation_from_vector(rotvec[None])[0] == pytest.approx(expm(skew(rotvec)), abs=1e-14)


@given(VECTORS, st.sampled_from([1.0, 1e-3, 1e-7, 0.0]))
def test_vector_and_rotation_are_inverse(vector, scale):
    rotvec = scale * np.array(vector)
    back = vector_from_rotation(rotation_from_vector(rotvec[None]))[0]
    assert back == pytest.approx(rotvec, abs=1e-12)


def test_vectors_of_turns_are_those_of_scipy():
    """Any turns, and one next to none and to a half turn, from where it is the other way round."""
    rng = np.random.default_rng(2)
    axes = rng.normal(size=(400, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    angles = [
        *np.geomspace(1e-17, 1e-2, 100),
        *rng.uniform(0.0, np.pi, 200),
        *(np.pi - np.geomspace(1e-9, 1.0, 100)),
    ]
    turns = Rotation.from_rotvec(axes * np.array(angles)[:, None])
    np.testing.assert_allclose(
        vector_from_rotation(turns.as_matrix()), turns.as_rotvec(), rtol=0.0, atol=1e-12
    )


HALF_TURNS = np.array([[1, 0, 0], [0, -1, 0], [0, 0, -1], [-1, 1, 0], [0, -1, 1], [-1, 0, -1], [-3, 2, 1]])


def test_quaternions_are_those_of_scipy():
    """Any turns, half turns, none, and matrices that are rotations to seven digits only."""
    rng = np.random.default_rng(3)
    axes = HALF_TURNS / np.linalg.norm(HALF_TURNS, axis=1, keepdims=True)
    turns = [*Rotation.random(400, rng=rng).as_matrix(), *(2 * axes[:, :, None] * axes[:, None] - np.eye(3))]
    exact = np.array([*turns, np.eye(3)])
    for R in (exact, exact + rng.normal(scale=1e-8, size=exact.shape)):
        expected = Rotation.from_matrix(R).as_quat(canonical=True)
        T = np.zeros((len(R), 4, 4))
        T[:, :3, :3] = R
        np.testing.assert_allclose(quaternion_xyzw(T), expected, rtol=0.0, atol=3e-16)
        np.testing.assert_array_equal(quaternion_xyzw(T[7]), quaternion_xyzw(T)[7])
        back = from_xyzw(T[:, :3, 3], 3.0 * expected)[:, :3, :3]
        np.testing.assert_allclose(back, Rotation.from_quat(expected).as_matrix(), rtol=0.0, atol=1e-15)
    assert quaternion_xyzw(np.empty((0, 4, 4))).shape == (0, 4)
    assert from_xyzw(np.empty((0, 3)), np.empty((0, 4))).shape == (0, 4, 4)


def test_what_is_no_rotation_has_no_quaternion_and_the_other_way_round():
    with pytest.raises(ValueError, match="determinant"):
        quaternion_xyzw(np.diag([1.0, 1.0, -1.0, 1.0]))
    with pytest.raises(ValueError, match="norm 0"):
        from_xyzw(np.zeros((2, 3)), np.array([[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 0.0]]))


def poses(n, seed=1):
    rng = np.random.default_rng(seed)
    T = np.tile(np.eye(4), (n, 1, 1))
    T[:, :3, :3] = Rotation.random(n, rng=rng).as_matrix()
    T[:, :3, 3] = rng.normal(size=(n, 3))
    return T, rng.normal(scale=0.01, size=(n, 6))


def test_many_poses_move_like_each_alone():
    T, twist = poses(20)
    moved = apply_twist(T, twist)
    for one, t, m in zip(T, twist, moved, strict=True):
        assert m == pytest.approx(apply_twist(one, t), abs=1e-13)
        assert twist_between(one[None], m[None])[0] == pytest.approx(twist_between(one, m), abs=1e-12)
        assert twist_between(one, m) == pytest.approx(t, abs=1e-12)


def test_moving_keeps_the_power_on_every_twist():
    """A rigid body's velocity at the new point, times the moved wrench, is the same power."""
    rng = np.random.default_rng(3)
    wrench, twist, arm = rng.normal(size=(50, 6)), rng.normal(size=(50, 6)), np.array([0.1, -0.3, 0.7])
    there = np.concatenate([twist[:, :3] + np.cross(twist[:, 3:], arm), twist[:, 3:]], axis=1)
    power = np.einsum("ni,ni->n", wrench, twist)
    assert np.einsum("ni,ni->n", shift_wrench(wrench, arm), there) == pytest.approx(power, abs=1e-12)


def test_turning_keeps_the_power():
    rng = np.random.default_rng(4)
    wrench, twist = rng.normal(size=(20, 6)), rng.normal(size=(20, 6))
    R = Rotation.random(20, rng=rng).as_matrix()
    power = np.einsum("ni,ni->n", wrench, twist)
    assert np.einsum("ni,ni->n", rotate_wrench(R, wrench), rotate_wrench(R, twist)) == pytest.approx(
        power, abs=1e-12
    )


def test_shift_by_hand():
    """10 N along y, 0.2 m in front along z: 0.2 z x 10 y = -2 N m about x."""
    moment = shift_wrench([0, 10.0, 0, 0, 0, 0], np.array([0, 0, -0.2]))
    assert moment == pytest.approx([0, 10, 0, -2, 0, 0])


def test_many_wrenches_and_many_rotations():
    rng = np.random.default_rng(1)
    wrench = rng.normal(size=(7, 6))
    R = np.stack([np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(7)])
    got = rotate_wrench(R, wrench)
    assert len(got) == 7
    for i in range(7):
        assert got[i] == pytest.approx(np.concatenate([R[i] @ wrench[i, :3], R[i] @ wrench[i, 3:]]))


@pytest.mark.parametrize(
    ("turn", "axis"), [(rotation_x, [1, 0, 0]), (rotation_y, [0, 1, 0]), (rotation_z, [0, 0, 1])]
)
def test_turns_about_an_axis(turn, axis):
    assert turn(0.3) == pytest.approx(expm(0.3 * skew(np.array(axis))), abs=1e-14)


@given(VECTORS)
def test_roll_pitch_and_yaw_are_turns_about_fixed_axes(angles):
    assert rotation_rpy(angles) == pytest.approx(Rotation.from_euler("xyz", angles).as_matrix(), abs=1e-14)
