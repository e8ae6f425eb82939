"""Inspected doors on the disk, and what is known of them in memory."""

import json
import shutil
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from doormill_ros.cell.graph.topic_names import RUN_RESULT
from doormill_ros.monitor.kept_doors import DOOR, DoorPoints, KeptDoors
from doormill_ros.monitor.recorded_runs import RecordedRuns
from doormill_ros.recording.bag_reader import read_bag
from support.source_tree import ROOT

BAGS = ("standard_door", "thesis_190_0deg", "thesis_1350_0deg")
BEGUN = datetime(2026, 11, 23, 6, tzinfo=UTC)


@pytest.fixture
def runs(tmp_path):
    """Run ids of recorded doors, and where their bags lie."""
    folder = tmp_path / "bags"
    for name in BAGS:
        shutil.copytree(ROOT / "bags" / name, folder / name)
    found = [item.message.run_id for name in BAGS for item in read_bag(folder / name, [f"/{RUN_RESULT}"])]
    return sorted(found), RecordedRuns(folder)  # their ids begin with when they were milled


def points(run_id, hour, deviation):
    """Two points of one hinge."""
    place = np.array([[0.01, 0.02, 0.0], [0.02, 0.02, 0.0]])
    return DoorPoints(
        run_id,
        BEGUN + timedelta(hours=hour),
        1e-5,
        "camera",
        ["hinge_1"] * 2,
        ["floor"] * 2,
        place,
        np.tile([0.0, 0.0, 1.0], (2, 1)),
        np.full(2, deviation),
    )


def test_what_is_known_is_what_another_reads_from_the_disk(tmp_path, runs):
    (first, second, third), recorded = runs
    kept = KeptDoors(tmp_path / "kept", recorded)

    def known():
        assert kept.doors() == KeptDoors(tmp_path / "kept", recorded).doors()
        return [(door.run_id, door.largest) for door in kept.doors()]

    assert known() == []
    kept.keep(points(second, 2, 2e-4))
    kept.keep(points(first, 1, 1e-4))
    assert known() == [(first, 1e-4), (second, 2e-4)]
    kept.keep(points(third, 0, 3e-4))
    kept.keep(points(first, 3, 4e-4))
    assert known() == [(first, 4e-4), (second, 2e-4), (third, 3e-4)]
    kept.refuse(second, "of no use")
    assert known() == [(first, 4e-4), (third, 3e-4)]
    kept.keep(points(second, 4, 5e-4))
    assert known() == [(first, 4e-4), (second, 5e-4), (third, 3e-4)]


def test_where_one_door_does_not_tell_when_it_was_milled_all_stand_as_they_were_measured(tmp_path, runs):
    (first, second, third), recorded = runs
    kept = KeptDoors(tmp_path, recorded)
    for hour, run_id in enumerate((third, first, second)):
        kept.keep(points(run_id, hour, 1e-4))
    assert [door.run_id for door in kept.doors()] == [first, second, third]
    path = kept.folder(first) / DOOR
    path.write_text(json.dumps({**json.loads(path.read_text()), "milled_at": ""}))
    assert [door.run_id for door in KeptDoors(tmp_path, recorded).doors()] == [third, first, second]


@pytest.mark.parametrize(
    "changes",
    [{"run_id": "another"}, {"measured_at": None}, {"largest": "much"}, {"door_id": 3}, {"colour": "red"}],
    ids=lambda changes: next(iter(changes)),
)
def test_a_door_that_cannot_be_read_is_passed_over(tmp_path, runs, changes):
    (first, second, _), recorded = runs
    kept = KeptDoors(tmp_path, recorded)
    for hour, run_id in enumerate((first, second)):
        kept.keep(points(run_id, hour, 1e-4))
    path = kept.folder(first) / DOOR
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))
    assert [door.run_id for door in KeptDoors(tmp_path, recorded).doors()] == [second]
