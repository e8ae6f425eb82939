"""A cell that was left leaves nothing behind for the next one of the same process."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from doormill_ros.nodes.one_process.cell import CellOptions, run_once
from doormill_ros.recording.bag_reader import read_bag

#: A loaded machine must not turn a good door into a refused one.
PATIENT = CellOptions({"abb_bridge": {"limit.recipe": 60.0, "limit.picture": 60.0, "limit.targets": 60.0}})
LATCHED = ("/door/recipe", "/path/nominal", "/abb/target_file", "/simulation/door_placement")


def test_what_one_cell_latched_does_not_reach_the_next(tmp_path: Path) -> None:
    assert run_once("thesis_190_0deg", tmp_path / "first", PATIENT).success
    second = run_once("no_such_door", tmp_path / "second", PATIENT)
    assert second.error_code == 140
    first = Counter(message.topic for message in read_bag(tmp_path / "first" / "bag"))
    assert all(first[topic] >= 1 for topic in LATCHED)
    results = [m.message.door_id for m in read_bag(tmp_path / "second" / "bag", ["/run/result"])]
    assert results == ["no_such_door"]
    found = Counter(message.topic for message in read_bag(tmp_path / "second" / "bag"))
    assert [topic for topic in LATCHED if found[topic]] == []
