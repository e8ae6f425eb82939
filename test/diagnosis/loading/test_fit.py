"""The fit against scipy, the one-step held-out prediction against honest refits, and gross errors."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from doormill_ros.diagnosis.core.fitting.fit import fit
from doormill_ros.diagnosis.core.fitting.problem import make_folds
from doormill_ros.diagnosis.core.fitting.robust import GROSS, robust_sum, trial_weights
from doormill_ros.diagnosis.loading.problem import LoadingProblem as Problem
from doormill_ros.robot_model.elastic.causes.registry import build_cause
from support.truth.loading_test import Spoil

EFFECTS = [
    {"cause": "joint_backlash", "where": "joint 2", "parameters": {"gap": 6e-5, "crossing": 80.0}},
    {
        "cause": "tracker_frame_rotation",
        "where": "tracker",
        "parameters": {"rotation_vector": [0.01, 0.03, -0.02]},
    },
    {"cause": "joint_offset", "where": "joint 3", "parameters": {"angle": 0.03}},
    {"cause": "link_bending", "where": "link 2", "parameters": {"EI": 1.2e7}},
    {"cause": "wrench_frame_rotation", "where": "sensor", "parameters": {"angle": -0.05}},
]


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda e: e["cause"])
def test_the_fit_is_that_of_scipy(make_set, effect):
    problem = Problem(make_set([effect], seed=11))
    cause = build_cause(effect["cause"], effect["where"])
    own = fit(problem, [cause])
    # Huber weights stay at one for every trial of an honest set once the model is right.
    np.testing.assert_array_equal(own.weights, 1.0)
    peer = least_squares(
        lambda theta: problem.predict([cause], theta).white.ravel(), own.theta * 1.05 + 1e-4, xtol=1e-12
    )
    std = np.sqrt(np.diag(own.covariance))
    assert np.all(np.abs(own.theta - peer.x) < 0.05 * std + 1e-6)
    smooth = [i for i in range(cause.size) if i not in cause.kinked]
    theirs = np.sqrt(np.diag(np.linalg.inv(peer.jac.T @ peer.jac)))
    np.testing.assert_allclose(std[smooth], theirs[smooth], rtol=0.05)


@pytest.mark.parametrize("effect", EFFECTS[1:], ids=lambda e: e["cause"])
def test_held_out_residuals_are_those_of_refits_without_the_configuration(make_set, effect):
    data = make_set([effect], seed=12)
    problem = Problem(data)
    members = [build_cause(effect["cause"], effect["where"]), build_cause("joint_stiffness", "joint 4")]
    own = fit(problem, members)
    assert set(problem.folds) == set(range(10))  # as many as the set has postures
    for fold in range(problem.folds.max() + 1):
        rows = problem.folds == fold
        peer = least_squares(
            lambda theta, rows=rows: problem.predict(members, theta).white[~rows].ravel(),
            own.theta,
            xtol=1e-12,
        )
        left = problem.predict(members, peer.x).residual[rows]
        in_sample = own.prediction.residual[rows]
        # What leaving the fold out changes is itself small; the shortcut must get that change right.
        change = np.linalg.norm(left - in_sample)
        assert np.linalg.norm(own.held_out[rows] - left) < 0.1 * change + 1e-8


def test_whole_configurations_are_left_out():
    configuration = np.repeat(np.arange(23), 5)
    folds = make_folds(configuration)
    assert folds.max() == 9
    for c in range(23):
        assert len(set(folds[configuration == c])) == 1
    assert np.bincount(folds).max() <= 15
    assert sorted(np.bincount(make_folds(np.zeros(20, dtype=int)))) == [2] * 10


def test_gross_errors_do_not_steer_the_fit(make_set):
    effect = EFFECTS[0]
    clean = Problem(make_set([effect], seed=13))
    data = clean.data
    rng = np.random.default_rng(0)
    bad = rng.choice(len(data), size=5, replace=False)
    spoilt = data.displacement.copy()
    spoilt[bad] += 3e-3 * rng.normal(size=(5, 3))
    dirty = Problem(replace(data, displacement=spoilt))
    cause = build_cause("joint_backlash", "joint 2")
    honest, robust = fit(clean, [cause]), fit(dirty, [cause])
    assert set(np.flatnonzero(robust.weights == 0.0)) == set(bad)
    assert abs(robust.theta[0] - honest.theta[0]) < 1.5 * np.sqrt(honest.covariance[0, 0])


def test_the_robust_sum_spares_one_trial_in_ten():
    cost = np.ones(50)
    cost[:7] = 1e6
    assert robust_sum(cost) == pytest.approx(5 * GROSS + 2e6 + 43)
    weights = trial_weights(cost, reject=True)
    assert np.sum(weights == 0.0) == 5
    np.testing.assert_array_equal(weights[7:], 1.0)


def test_an_unknown_direction_is_read_from_the_trial(make_set):
    data = make_set([{**EFFECTS[0], "parameters": {"gap": 2e-4, "crossing": 0.0}}], seed=14)
    blind = replace(data, direction=np.zeros_like(data.direction))
    cause = build_cause("joint_backlash", "joint 2")
    known, unknown = fit(Problem(data), [cause]), fit(Problem(blind), [cause])
    std = np.sqrt(unknown.covariance[0, 0])
    assert std < 2.0 * np.sqrt(known.covariance[0, 0])
    assert abs(unknown.theta[0] - 2.0) < 4.0 * std


def test_noise_is_propagated_from_the_force_sensor(make_set):
    """The covariance of a trial against a thousand simulated readings of tracker and sensor."""
    data = make_set(seed=15, trials=20, postures=5, spoil=Spoil())
    loud = replace(data, noise=type(data.noise)(2e-6, 20.0, 5.0))
    problem = Problem(loud)
    rng = np.random.default_rng(1)
    noise = np.repeat([20.0, 5.0], 3)
    still = problem.predict([], np.zeros(0)).residual
    draws = []
    for _ in range(1000):
        moved = Problem(replace(loud, wrench=loud.wrench + rng.normal(size=loud.wrench.shape) * noise))
        draws.append(moved.predict([], np.zeros(0)).residual - still + rng.normal(0.0, 2e-6, still.shape))
    white = np.einsum("nij,dnj->dni", problem.whiten, np.array(draws))
    np.testing.assert_allclose(np.mean(white**2), 1.0, atol=0.03)
    np.testing.assert_allclose(np.mean(white**2, axis=(0, 2)), 1.0, atol=0.25)
