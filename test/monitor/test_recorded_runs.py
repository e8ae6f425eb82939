"""Which bag holds a run, while others remove what lies beside the bags."""

import os
import shutil

from doormill_ros.monitor.recorded_runs import RESULT, RecordedRuns
from doormill_ros.recording.bag_reader import read_bag
from support.source_tree import ROOT

BAG = ROOT / "bags" / "standard_door"


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
