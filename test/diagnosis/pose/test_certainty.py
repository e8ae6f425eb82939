"""How far off a new pose is expected to be holds for rows and series that no fit has seen, in worlds of known truth."""

import dataclasses

import numpy as np
import pytest

from doormill_ros.diagnosis.pose.diagnosis import diagnose_poses
from doormill_ros.diagnosis.pose.telling.certainty import certainties, certainty_section
from doormill_ros.measurements.sets.pose_set import read_pose_set

CASE = {"geometry": [(2, "a", 4e-4), (3, "alpha", 5e-4)], "sag": [(2, 2e-5)], "periodic": [(1, 2, 3e-4, 0.3)]}


@pytest.fixture(scope="module")
def sets(tmp_path_factory, write_arm_sets, arm):
    world = arm(names=("one", "two", "three"), **CASE)
    return [
        read_pose_set(folder) for folder in write_arm_sets(tmp_path_factory.mktemp("sure"), world, 200, 9)
    ]


def test_intervals_of_95_percent_hold_so_many(sets):
    section = certainty_section(diagnose_poses(sets))
    assert set(section) == {"blocks_left_out", "series_left_out"}
    for entries in section.values():
        assert [one["set"] for one in entries] == ["one", "two", "three"]
        for one in entries:
            # 600 components: 95 +- 0.9 %.
            assert 0.92 < one["within_95"] < 0.98
            assert one["rmse"] == pytest.approx(one["expected_rmse"], rel=0.15)
            assert len(one["groups"]) == 5


def test_a_series_unlike_the_others_is_expected_to_be_worse(sets):
    """Joints 1 to 4 known through a small range alone: a series from elsewhere is foreseen to be off by more."""
    columns = ("row", "time", "temperature", "q", "position", "placement")
    narrow = []
    for data in sets[:2]:
        rows = np.flatnonzero(np.abs(data.q[:, 1]) < 0.7)
        narrow.append(dataclasses.replace(data, **{name: getattr(data, name)[rows] for name in columns}))
    found = diagnose_poses([*narrow, sets[2]])
    *_, wide = certainties(found, found.extended.validation.series, found.after.series)
    inside = np.median(wide.expected[np.argsort(wide.expected)[:40]])
    assert np.quantile(wide.expected, 0.95) > 1.1 * inside
    near, far = np.array_split(wide.off[np.argsort(wide.expected, kind="stable")], 2)
    assert np.mean(far**2) > np.mean(near**2)
