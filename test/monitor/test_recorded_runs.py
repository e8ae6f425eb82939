"""Which bag holds a run, while others remove what lies beside the bags."""

import os
import shutil

import pytest

from doormill_ros.cell.graph import topic_names
from doormill_ros.monitor.recorded_runs import RecordedRuns
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.bag_writer import BagWriter
from support.real_bags import as_real
from support.source_tree import ROOT

BAG = ROOT / "bags" / "standard_door"
RECIPE, LOCALIZATION, TARGETS, EXECUTED_PATH, RESULT = NEEDED = [
    f"/{name}"
    for name in (
        topic_names.DOOR_RECIPE,
        topic_names.DOOR_LOCALIZATION,
        topic_names.PATH_TARGETS,
        topic_names.EXECUTED_PATH,
        topic_names.RUN_RESULT,
    )
]


def test_a_folder_that_vanishes_during_the_search_hides_no_run(tmp_path, monkeypatch):
    shutil.copytree(BAG, tmp_path / "bag")
    (tmp_path / "answer.new").mkdir()
    scan, vanished = os.scandir, []

    def scandir(path):
        if os.fspath(path).endswith("answer.new"):
            vanished.append(path)
            raise FileNotFoundError(2, "No such file or directory", os.fspath(path))
        return scan(path)

    (end,) = [item.message for item in read_bag(BAG, [RESULT])]
    monkeypatch.setattr(os, "scandir", scandir)
    found = RecordedRuns(tmp_path).find(end.run_id)
    assert vanished
    assert (found.bag, found.door_id) == (tmp_path / "bag", end.door_id)


@pytest.mark.parametrize("late", NEEDED)
def test_a_run_is_not_there_before_all_that_is_asked_of_it(tmp_path, late):
    messages = list(read_bag(BAG))
    (end,) = [item.message for item in messages if item.topic == RESULT]
    writer = BagWriter(tmp_path / "bag")
    for item in messages:
        writer.add_topic(item.topic, item.type_name)
    # Of the door before, whose pose and path are in the bag.
    for item in messages:
        if item.topic in NEEDED:
            former = item.data.replace(end.run_id.encode(), b"2" * len(end.run_id))
            writer.write(item.topic, former, item.stamp_ns)
    for item in messages:
        if item.topic != late:
            writer.write(item.topic, item.data, item.stamp_ns)
    writer.flush(force=True)
    runs = RecordedRuns(tmp_path)
    assert runs.find("2" * len(end.run_id)).door_id == end.door_id
    assert runs.find(end.run_id) is None
    assert runs.find(end.run_id) is None
    for item in messages:
        if item.topic == late:
            writer.write(item.topic, item.data, item.stamp_ns)
    writer.flush(force=True)
    assert runs.find(end.run_id).door_id == end.door_id


def test_nothing_more_is_waited_for_once_a_bag_is_closed(tmp_path):
    messages = [item for item in read_bag(BAG) if item.topic != EXECUTED_PATH]
    writer = BagWriter(tmp_path / "bag")
    for item in messages:
        writer.add_topic(item.topic, item.type_name)
        writer.write(item.topic, item.data, item.stamp_ns)
    writer.flush(force=True)
    (end,) = [item.message for item in messages if item.topic == RESULT]
    runs = RecordedRuns(tmp_path)
    assert runs.find(end.run_id) is None
    writer.close()
    assert runs.find(end.run_id).door_id == end.door_id


def test_a_real_controller_whose_bag_is_still_recorded_keeps_nobody_waiting(tmp_path):
    (end,) = [item.message for item in read_bag(BAG, [RESULT])]
    as_real(BAG, tmp_path / "bag", close=False)
    assert RecordedRuns(tmp_path).find(end.run_id).door_id == end.door_id
