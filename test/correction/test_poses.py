"""Batched displacements against scipy's matrix exponential and the one-pose functions of frames."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from doormill_ros.correction.poses import (
    displace,
    rotation_from_vector,
    twist_to,
    undisplace,
    vector_from_rotation,
)
from doormill_ros.frames import apply_twist, transform, twist_between

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


def poses(n, seed=1):
    rng = np.random.default_rng(seed)
    T = np.tile(np.eye(4), (n, 1, 1))
    T[:, :3, :3] = Rotation.random(n, rng=rng).as_matrix()
    T[:, :3, 3] = rng.normal(size=(n, 3))
    return T, rng.normal(scale=0.01, size=(n, 6))


def test_displacing_agrees_with_the_single_pose_functions():
    T, twist = poses(20)
    moved = displace(T, twist)
    for one, t, m in zip(T, twist, moved, strict=True):
        assert m == pytest.approx(apply_twist(one, t), abs=1e-13)
        assert twist_to(one[None], m[None])[0] == pytest.approx(twist_between(one, m), abs=1e-12)


def test_undisplacing_is_the_way_back():
    T, twist = poses(20, seed=2)
    assert displace(undisplace(T, twist), twist) == pytest.approx(T, abs=1e-14)
    assert undisplace(T, twist)[0] != pytest.approx(transform(T[0, :3, :3], T[0, :3, 3]), abs=1e-4)
