"""Blocks of normal equations, learnt sizes and conditioning against plain linear algebra."""

import numpy as np
import pytest

from doormill_ros.diagnosis.core.fitting.ridge import add_up, solve, without
from doormill_ros.diagnosis.pose.fitting.fit import Fitted, contiguous, fit_causes, place_nominally
from doormill_ros.diagnosis.pose.fitting.model import distinct_share
from doormill_ros.diagnosis.pose.fitting.problem import PoseProblem
from doormill_ros.diagnosis.pose.fitting.validation import Validation
from doormill_ros.measurements.sets.pose_set import read_pose_set
from doormill_ros.robot_model.pose.causes.joint_periodic_error import JointPeriodicError
from doormill_ros.robot_model.pose.causes.joint_sag import JointSag
from doormill_ros.robot_model.pose.causes.joint_wobble import JointWobble
from doormill_ros.robot_model.pose.causes.link_geometry import LinkGeometry
from doormill_ros.robot_model.pose.causes.thermal_drift import PoseDrift
from doormill_ros.robot_model.pose.causes.tracker_scale import PoseTrackerScale


@pytest.fixture
def problem(tmp_path, write_pose_sets, faults):
    folders = write_pose_sets(tmp_path, faults(sag=[(2, 1e-5)], geometry=[(3, "a", 3e-4)]), 60, 8)
    sets = [read_pose_set(folder) for folder in folders]
    causes = [
        LinkGeometry("link 3", sets[0].dh),
        JointSag("joint 2"),
        JointPeriodicError("joint 4", range(1, 12)),
        JointPeriodicError("joint 5", range(2, 13)),
        JointWobble("joint 2", (2,)),
        PoseDrift("set second"),
    ]
    return PoseProblem(sets, causes, place_nominally(sets))


def numeric_jacobian(problem, series):
    """Derivative of the whitened residual by causes and placement, by differences."""
    scale = np.repeat(1.0 / np.array(problem.sigmas[0]), 3)
    J = np.zeros((len(problem.sets[series]) * 6, problem.size))
    h = 1e-6
    for i in range(problem.layout.size):
        up, down = problem.x.copy(), problem.x.copy()
        up[i] += h
        down[i] -= h
        change = problem.residual(series, down) - problem.residual(series, up)
        J[:, i] = (change * scale).ravel() / (2.0 * h)
    start = problem.placements[series]
    for i, where in enumerate(problem.placement_ids(series)):
        ends = []
        for sign in (-h, h):
            step = np.zeros(12)
            step[i] = sign
            problem.placements[series] = start.moved(step[:6], step[6:])
            ends.append(problem.residual(series))
        # The base of a moved placement carries its axes along: turn residuals back.
        problem.placements[series] = start
        J[:, where] = ((ends[0] - ends[1]) * scale).ravel() / (2.0 * h)
    return J


def blocks_of(problem):
    return [
        problem.linear(series).normal_equations(rows)
        for series, data in enumerate(problem.sets)
        for rows in contiguous(len(data))
    ]


def test_blocks_hold_the_products_of_the_derivatives(problem):
    problem.weights[0][3] = 0.25
    H, g = add_up(blocks_of(problem), problem.size)
    J = [numeric_jacobian(problem, series) for series in range(2)]
    scale = np.repeat(1.0 / np.array(problem.sigmas[0]), 3)
    weights = [np.repeat(w, 6) for w in problem.weights]
    cut = problem.layout.size
    wanted = sum(j.T @ (w[:, None] * j) for j, w in zip(J, weights, strict=True))
    np.testing.assert_allclose(
        H[:cut, :cut], wanted[:cut, :cut], rtol=1e-3, atol=1e-4 * np.abs(wanted[:cut, :cut]).max()
    )
    slope = sum(
        j.T @ (w * (problem.residual(s) * scale).ravel())
        for s, (j, w) in enumerate(zip(J, weights, strict=True))
    )
    np.testing.assert_allclose(g[:cut], slope[:cut], rtol=1e-3, atol=1e-4 * np.abs(slope[:cut]).max())


def test_blocks_pull_at_a_solution_what_their_normal_equations_leave(problem):
    problem.share = 0.5
    problem.weights[1][7] = 0.25
    x = np.random.default_rng(6).normal(scale=1e-4, size=problem.size)
    blocks = blocks_of(problem)
    assert len(blocks) == 20
    for series, data in enumerate(problem.sets):
        pulls = problem.linear(series).pulls(x, contiguous(len(data)))
        own = [block for block in blocks if block.series == series]
        for block, (pull, curvature) in zip(own, pulls, strict=True):
            wanted = block.g - block.H @ x[block.ids]
            np.testing.assert_allclose(pull, wanted, rtol=1e-8, atol=1e-10 * np.abs(wanted).max())
            np.testing.assert_allclose(curvature, np.diag(block.H), rtol=1e-10)


def test_rows_at_once_are_the_rows_block_by_block(tmp_path, write_pose_sets, faults):
    """Of more rows than are multiplied at a time; a scale acts in three directions at once."""
    [folder] = write_pose_sets(tmp_path, faults(names=["one"]), 1100, 8)
    data = read_pose_set(folder)
    causes = [JointPeriodicError("joint 4", range(1, 12)), PoseTrackerScale("tracker")]
    linear = PoseProblem([data], causes, place_nominally([data])).linear(0)
    whole = linear.normal_equations(np.arange(1100))
    parts = [linear.normal_equations(rows) for rows in contiguous(1100)]
    np.testing.assert_allclose(whole.H, sum(part.H for part in parts), rtol=1e-9, atol=1e-9 * whole.H.max())
    np.testing.assert_allclose(whole.g, sum(part.g for part in parts), atol=1e-9 * np.abs(whole.g).max())
    J = (linear.effect(np.arange(1100), 6) * linear.scale[:, None]).reshape(-1, len(linear.x))
    np.testing.assert_allclose(whole.H, J.T @ J, rtol=1e-9, atol=1e-9 * whole.H.max())


def test_solve_is_ridge_regression():
    rng = np.random.default_rng(2)
    J, y = rng.normal(size=(40, 6)), rng.normal(size=40)
    variance = np.array([0.5, 2.0, 1.0, 0.1, np.inf, np.inf])
    found = solve(J.T @ J, J.T @ y, variance)
    precision = np.diag(np.append(1.0 / variance[:4], [0.0, 0.0]))
    np.testing.assert_allclose(found.x, np.linalg.solve(J.T @ J + precision, J.T @ y), rtol=1e-6)
    np.testing.assert_allclose(found.covariance, np.linalg.inv(J.T @ J + precision), rtol=1e-6)


def test_taking_away_is_refitting_without():
    rng = np.random.default_rng(3)
    J, y = rng.normal(size=(50, 8)), rng.normal(size=50)
    variance = rng.uniform(0.1, 2.0, 8)
    gone = np.array([1, 4, 5])
    stay = np.setdiff1d(np.arange(8), gone)
    found = without(solve(J.T @ J, J.T @ y, variance), gone)
    alone = solve(J[:, stay].T @ J[:, stay], J[:, stay].T @ y, variance[stay])
    np.testing.assert_allclose(found.x[stay], alone.x, rtol=1e-8)
    np.testing.assert_allclose(found.x[gone], 0.0)
    np.testing.assert_allclose(found.covariance[np.ix_(stay, stay)], alone.covariance, rtol=1e-8)


def test_held_out_rows_do_not_touch_their_prediction(tmp_path, write_pose_sets, faults):
    folders = write_pose_sets(tmp_path, faults(sag=[(2, 1e-5)]), 100, 9)
    sets = [read_pose_set(folder) for folder in folders]
    causes = [JointSag("joint 2"), LinkGeometry("link 3", sets[0].dh)]
    fitted = fit_causes(sets, causes, place_nominally(sets), 2)
    before = Validation(fitted).residuals(Validation(fitted).blocks)
    # Rows predicted by fold 0: spoil their normal equations, the prediction must not move.
    spoilt = Fitted(fitted.problem, fitted.learnt)
    spoilt.solution = fitted.solution
    for b in spoilt.folds[0]:
        b.g[:] += 1e3
    after = Validation(spoilt)
    after = after.residuals(after.blocks)
    rows = fitted.folds[0][0].rows
    np.testing.assert_allclose(after[0][rows], before[0][rows], atol=1e-12)
    others = fitted.folds[1][0].rows
    assert np.abs(after[0][others] - before[0][others]).max() > 1e-9


def test_what_a_placement_imitates_is_seen(tmp_path, write_pose_sets, faults):
    """Theta and d of link 1 and all of link 6 are claimed to belong to the placement: so the data say."""
    sets = [read_pose_set(folder) for folder in write_pose_sets(tmp_path, faults(), 60, 8)]

    class Everything(LinkGeometry):
        def __init__(self, where, dh):
            super().__init__(where, dh)
            self.names = tuple(dict.fromkeys([*self.hidden, *self.names]))

    causes = [Everything(f"link {k}", sets[0].dh) for k in (1, 2, 6)]
    fitted = fit_causes(sets, causes, place_nominally(sets), 1)
    share = distinct_share(fitted)
    names = [(c.where, p.name) for c in causes for p in c.coefficients]
    imitated = {name for name, part in zip(names, share, strict=True) if part < 1e-6}
    assert imitated == {("link 1", "theta"), ("link 1", "d")} | {
        ("link 6", n) for n in ("theta", "d", "a", "alpha")
    }
