"""Proposed poses: they tell more than random ones, and what they promise comes true."""

import numpy as np
import pytest

from doormill_ros.diagnosis.pose.diagnosis import diagnose_poses
from doormill_ros.diagnosis.pose.telling.next_poses import effect_on_pose, plan_next, possible_poses, propose
from doormill_ros.measurements.sets.pose_set import read_pose_set


@pytest.fixture(scope="module")
def found(tmp_path_factory, write_pose_sets, faults):
    """Link 2 is long and joint 3 wanders, yet joint 3 was moved through forty degrees alone."""
    case = faults(geometry=[(2, "a", 4e-4), (3, "theta", 3e-4)], periodic=[(3, 1, 4e-4, 0.7)])
    folders = write_pose_sets(tmp_path_factory.mktemp("narrow"), case, 900, 41)
    for folder in folders:
        lines = (folder / "poses.csv").read_text().splitlines()
        narrow = [line for line in lines[1:] if abs(float(line.split(",")[5]) - 0.6) < 0.35]
        (folder / "poses.csv").write_text("\n".join([lines[0], *narrow]) + "\n")
    return diagnose_poses([read_pose_set(folder) for folder in folders])


def expected_error(found, measured, asked):
    """Position error at some poses from what stays uncertain once others are measured, by plain least squares [m]."""
    scale = np.repeat(found.extended.problem.sigmas[-1], 3)
    C = found.extended.solution.covariance
    if len(measured):
        A = (effect_on_pose(found, measured) / scale[:, None]).reshape(-1, len(C))
        # Numbers of very different size: solved in units of their own standard deviations.
        unit = np.sqrt(np.diag(C))
        C = np.linalg.inv(np.linalg.inv(C / np.outer(unit, unit)) + (A * unit).T @ (A * unit)) * np.outer(
            unit, unit
        )
    B = effect_on_pose(found, asked)[:, :3]
    return np.sqrt(np.mean(np.einsum("nia,ab,nib->n", B, C, B)))


def test_the_promise_is_what_least_squares_gives(found):
    poses = propose(found)
    asked = possible_poses(found, 0)
    assert poses.before == pytest.approx(expected_error(found, [], asked), rel=1e-6)
    assert poses.after == pytest.approx(expected_error(found, poses.q, asked), rel=1e-3)
    assert np.all(np.diff(poses.information) < 1e-9)


def test_proposed_poses_tell_more_than_random_ones(found):
    poses, asked = propose(found), possible_poses(found, 5)
    proposed = expected_error(found, poses.q, asked)
    random = [expected_error(found, possible_poses(found, seed)[:12], asked) for seed in range(10, 20)]
    assert proposed < min(random)
    assert proposed < 0.5 * expected_error(found, [], asked)


def test_they_go_where_joint_3_was_not(found):
    visited = np.concatenate([data.q[:, 2] for data in found.sets])
    q3 = propose(found).q[:, 2]
    assert np.mean((q3 < visited.min()) | (q3 > visited.max())) > 0.6
    assert "12 poses" in plan_next(found, propose(found))


def test_possible_poses_keep_the_target_where_targets_were(found, invented):
    problem = found.extended.problem
    heights = []
    for data, placement in zip(found.sets, problem.placements, strict=True):
        T = placement.T_tracker_base
        heights.append(((data.position - T[:3, 3]) @ T[:3, :3])[:, 2])
    q = possible_poses(found, 1)
    offset = problem.placements[-1].T_flange_target[:, 3]
    now = [(invented["pose"](one, invented["dh"]) @ offset)[2] for one in q]
    assert q.shape == (300, 6)
    assert min(now) > min(map(np.min, heights))
    assert np.abs(q).max() <= np.pi
    assert (q.max(axis=0) - q.min(axis=0)).min() > 5.5
