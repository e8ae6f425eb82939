"""The measured UR10: a sixth of its rows, which causes and how well blocks left out are predicted."""

import dataclasses

import numpy as np
import pytest

from doormill_ros.diagnosis.pose.diagnosis import diagnose_poses
from doormill_ros.diagnosis.pose.fitting.model import rmse
from doormill_ros.measurements.sets.pose_set import read_pose_set
from support.source_tree import DATA

NAMES = ("grid", "joint-configurations", "random-poses")


@pytest.fixture(scope="module")
def found():
    sets = []
    for name, every in zip(NAMES, (10, 2, 3), strict=True):
        data = read_pose_set(DATA / "ur10" / name)
        rows = np.arange(len(data))[::every]
        columns = ("row", "time", "temperature", "q", "position", "rotation", "placement")
        sets.append(dataclasses.replace(data, **{column: getattr(data, column)[rows] for column in columns}))
    return diagnose_poses(sets)


def test_the_nominal_model_is_as_wrong_as_published(found):
    """0.8 to 1.0 mm by the task that came with the data."""
    kept = [~bad for bad in found.gross]
    assert len(kept) == len(NAMES)
    for errors, good in zip(found.before.blocks, kept, strict=True):
        assert 0.75e-3 < rmse([errors], [good]) < 1.1e-3


def test_every_joint_has_a_periodic_error_and_the_big_ones_sag(found):
    names = {score.cause.key for score in found.established}
    assert {("joint_periodic_error", f"joint {k}") for k in range(1, 7)} <= names
    assert {("joint_sag", "joint 2"), ("joint_sag", "joint 3")} <= names
    assert {("link_geometry", "link 2"), ("link_geometry", "link 3")} <= names
    # Links 3 and 4 are both short by 0.1 %, which no tracker is.
    assert ("tracker_scale", "tracker") not in names
    assert found.verdict == "partly_explained"


def test_blocks_left_out_are_predicted_to_a_tenth_of_a_millimetre(found):
    for errors, bad in zip(found.after.blocks, found.gross, strict=True):
        assert rmse([errors], [~bad]) < 0.11e-3
    assert sum(bad.sum() for bad in found.gross) < 20


def test_whole_series_left_out_gain_too(found):
    assert len(found.gross) == len(NAMES)
    for before, after, bad in zip(found.before.series, found.after.series, found.gross, strict=True):
        assert rmse([after], [~bad]) < 0.5 * rmse([before], [~bad])
