"""What keeps a fit from believing too much: rows that err alike, angles nobody visited, a turn that moves nothing."""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.diagnosis.pose.fitting.fit import contiguous, fit_causes, place_nominally
from doormill_ros.diagnosis.pose.fitting.validation import Validation
from doormill_ros.diagnosis.pose.searching.selection import CONTRADICTED, REAL, scores
from doormill_ros.measurements.sets.pose_set import read_pose_set
from doormill_ros.robot_model.pose.causes.joint_backlash import PoseBacklash
from doormill_ros.robot_model.pose.causes.joint_periodic_error import BROAD, JointPeriodicError
from doormill_ros.robot_model.pose.causes.joint_sag import JointSag
from doormill_ros.robot_model.pose.causes.joint_waves import harmonics

SPECTRUM = tuple(range(1, BROAD + 1))


@pytest.fixture
def read(tmp_path, write_pose_sets, faults):
    def run(case, rows=300, seed=51):
        return [read_pose_set(folder) for folder in write_pose_sets(tmp_path, faults(**case), rows, seed)]

    return run


def fit(sets, causes):
    return fit_causes(sets, causes, place_nominally(sets), passes=3)


def test_rows_that_err_alike_count_for_less(read):
    sets = read({"sag": [(2, 1e-5)]})
    alone = fit(sets, [JointSag("joint 2")])
    rng = np.random.default_rng(2)
    drifting = []
    for data in sets:
        shift = np.zeros((len(data), 3))
        for rows in contiguous(len(data)):
            shift[rows] = rng.normal(0.0, 4e-5, 3)
        drifting.append(dataclasses.replace(data, position=data.position + shift))
    alike = fit(drifting, [JointSag("joint 2")])
    assert alone.problem.share > 0.6
    assert alike.problem.share < 0.25
    # More than the larger residual asks for by itself.
    larger = alike.problem.sigmas[0][0] / alone.problem.sigmas[0][0]
    spread = [np.sqrt(one.solution.covariance[0, 0]) for one in (alone, alike)]
    assert spread[1] > 1.5 * larger * spread[0]
    assert abs(alike.solution.x[0] - 1e-5) < 3.0 * spread[1]


def test_a_spectrum_goes_to_zero_where_nobody_was(read):
    """Joint 1 seen through a radian: inside the true curve, half a radian beyond it next to nothing."""
    sets = read({"periodic": [(1, 14, 3e-4, 0.0), (1, 9, 2e-4, 1.0)]}, 1500)
    columns = ("row", "time", "temperature", "q", "position", "rotation", "placement")
    narrow = []
    for data in sets:
        rows = np.flatnonzero(np.abs(data.q[:, 0]) < 0.8)
        narrow.append(dataclasses.replace(data, **{name: getattr(data, name)[rows] for name in columns}))
    found = fit(narrow, [JointPeriodicError(f"joint {k}", SPECTRUM) for k in (1, 2)])
    angle = np.linspace(-np.pi, np.pi, 1440)
    curve = harmonics(angle, SPECTRUM) @ found.solution.x[: 2 * BROAD]
    truth = 3e-4 * np.cos(14 * angle) + 2e-4 * np.cos(9 * angle - 1.0)
    inside, outside = np.abs(angle) < 0.7, np.abs(angle) > 1.3
    # A constant turn of joint 1 is a turned base and belongs to the placement.
    error = (curve - truth)[inside]
    assert np.std(error) < 0.1 * np.std(truth)
    assert np.sqrt(np.mean(curve[outside] ** 2)) < 0.35 * np.std(truth)


@pytest.mark.parametrize(("moves", "status"), [(True, REAL), (False, CONTRADICTED)])
def test_a_joint_that_turns_the_target_has_to_move_it_too(read, moves, status):
    """Play in joint 5 is believed; the same turn of the target's orientation alone is not, however regular."""
    sets = read({"backlash": [(5, 3e-4)]} if moves else {})
    if not moves:
        turned = []
        for data in sets:
            found = fit([data], [])
            axis = (
                found.problem.placements[0].T_tracker_base[:3, :3]
                @ found.problem.frames(0)[:, 4, :3, 2, None]
            )
            last = found.problem.views[0].last_motion[:, 4, None]
            turn = Rotation.from_rotvec(1.5e-4 * last * axis[:, :, 0]).as_matrix()
            turned.append(dataclasses.replace(data, rotation=turn @ data.rotation))
        sets = turned
    validation = Validation(fit(sets, [PoseBacklash("joint 5")]))
    [score] = scores(validation, [0], 1.0)
    assert score.total > 100.0
    assert score.status == status
