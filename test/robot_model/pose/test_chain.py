"""The forward model against a robot written down differently, its derivatives against differences."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.frames import displacement
from doormill_ros.robot_model.pose.chain import (
    Placement,
    derivatives,
    direction,
    frames,
    joint_turn,
    link_transforms,
    residual,
)
from doormill_ros.robot_model.pose.link_masses import LinkMass, gravity_moment
from doormill_ros.robot_model.pose.view import last_motion


@pytest.fixture
def q():
    return np.random.default_rng(3).uniform(-2.5, 2.5, (9, 6))


@pytest.fixture
def placement():
    rng = np.random.default_rng(4)
    return Placement(displacement(rng.normal(size=6)), displacement(0.2 * rng.normal(size=6)))


def test_nominal_poses(q, invented):
    found = frames(link_transforms(invented["dh"], q))[:, -1]
    np.testing.assert_allclose(found, [invented["pose"](one, invented["dh"]) for one in q], atol=1e-12)


@pytest.mark.parametrize(
    ("link", "name", "where"),
    [
        (3, "theta", direction(2, 5)),
        (4, "d", direction(3, 2)),
        (2, "a", direction(2, 0)),
        (5, "alpha", direction(5, 3)),
        (3, "beta", direction(3, 4)),
    ],
)
def test_a_wrong_link_is_a_displaced_frame(q, invented, link, name, where):
    size = 2e-3
    dh, beta = invented["dh"].copy(), []
    if name == "beta":
        beta = [(link, size)]
    else:
        dh[link - 1, ["theta", "d", "a", "alpha"].index(name)] += size
    twists = np.zeros((len(q), 42))
    twists[:, where] = size
    found = frames(link_transforms(invented["dh"], q), twists.reshape(-1, 7, 6))[:, -1]
    np.testing.assert_allclose(found, [invented["pose"](one, dh, beta) for one in q], atol=1e-12)


def test_derivatives_are_those_of_the_residual(q, invented, placement):
    links = link_transforms(invented["dh"], q)
    now = np.random.default_rng(5).normal(scale=1e-3, size=(len(q), 7, 6))
    T = frames(links, now)
    target = placement.T_tracker_base @ T[:, -1] @ placement.T_flange_target
    D = derivatives(T, placement)
    h = 1e-6
    for where in range(42):
        step = np.zeros((len(q), 42))
        step[:, where] = h
        moved = T.copy()
        frame = where // 6
        # Move the frame and everything beyond it by a small twist in its own axes.
        shift = T[:, frame] @ displacement(step.reshape(-1, 7, 6)[:, frame]) @ np.linalg.inv(T[:, frame])
        moved[:, -1] = shift @ T[:, -1]
        error = residual(moved, placement, target[:, :3, 3], target[:, :3, :3])
        np.testing.assert_allclose(-error / h, D[:, where], atol=2e-5)


def test_residual_is_in_base_axes(q, invented, placement):
    T = frames(link_transforms(invented["dh"], q))
    shift, turn = np.array([1e-3, -2e-3, 5e-4]), np.array([3e-4, 1e-4, -2e-4])
    pose = T[:, -1] @ placement.T_flange_target
    position = (pose[:, :3, 3] + shift) @ placement.T_tracker_base[:3, :3].T + placement.T_tracker_base[:3, 3]
    rotation = placement.T_tracker_base[:3, :3] @ Rotation.from_rotvec(turn).as_matrix() @ pose[:, :3, :3]
    error = residual(T, placement, position, rotation)
    np.testing.assert_allclose(error, np.tile(np.concatenate([shift, turn]), (len(q), 1)), atol=1e-12)


def test_gravity_moment_is_the_slope_of_the_energy(q, invented):
    from_set = [
        LinkMass(7.0, np.array([0.02, 0.0, 0.03])),
        LinkMass(13.0, np.array([0.37, 0.0, 0.16])),
        LinkMass(4.0, np.array([0.25, 0.0, 0.07])),
        LinkMass(2.0, np.array([0.0, 0.007, 0.018])),
        LinkMass(2.0, np.array([0.0, 0.007, 0.018])),
        LinkMass(0.4, np.array([0.0, 0.0, -0.026])),
    ]
    moment = gravity_moment(frames(link_transforms(invented["dh"], q)), from_set, np.array([0.0, 0.0, -1.0]))
    for k in range(1, 7):
        by_energy = [invented["torque"](one, k) for one in q]
        np.testing.assert_allclose(moment[:, k - 1, 2], by_energy, atol=1e-5)
        assert joint_turn(k) == 6 * (k - 1) + 5


def test_last_motion_follows_stays_and_forgets():
    angle = np.array([0.0, 0.1, 0.2, 0.2 + 1e-6, 0.15, 0.05, 0.06])
    q = np.tile(angle[:, None], (1, 6))
    row = np.array([0, 1, 2, 3, 4, 5, 8])
    state = last_motion(q, row)[:, 0]
    np.testing.assert_allclose(state, [0, 1, 1, 1, -1, -1, 0], atol=0.01)
