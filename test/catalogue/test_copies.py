"""Bags that were copied in part, spoiled, renamed or taken away before the catalogue is made anew."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from doormill_ros.catalogue.database import Catalogue
from doormill_ros.catalogue.rebuild import rebuild
from doormill_ros.tools.catalogue import main
from support.run_bags import RECORDER, DrawnRun, write_run_bag
from support.source_tree import ROOT


def told(url: str, *places: Path) -> list[str]:
    """What is refused."""
    with Catalogue(url) as catalogue:
        return [found.refused for found in rebuild(catalogue, places) if found.refused]


def bags_of(url: str) -> dict[str, str]:
    """Where the bag of each run lies."""
    with Catalogue(url) as catalogue:
        return {row.run.run_id: row.run.bag for row in catalogue.rows()}


def cut(bag: Path, share: float) -> None:
    (path,) = bag.glob("*.mcap")
    path.write_bytes(path.read_bytes()[: int(path.stat().st_size * share)])


def test_a_bag_copied_in_part_is_named_and_takes_nothing_from_the_whole_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    url, bag = str(tmp_path / "catalogue.sqlite"), tmp_path / "bags" / "a"
    write_run_bag(bag, [DrawnRun("run_0"), DrawnRun("run_1")])
    assert told(url, tmp_path / "bags") == []
    copy = Path(shutil.copytree(bag, tmp_path / "bags" / "b"))
    cut(copy, 0.2)
    assert main(["--database", url, "rebuild", str(tmp_path / "bags")]) == 1
    said = capsys.readouterr().err
    assert str(copy) in said
    assert "messages that its metadata.yaml lists" in said
    assert bags_of(url) == {"run_0": str(bag), "run_1": str(bag)}


def test_a_copy_in_part_that_looks_as_if_its_recorder_was_killed_takes_nothing_either(tmp_path: Path) -> None:
    url, bag = str(tmp_path / "catalogue.sqlite"), tmp_path / "bags" / "a"
    write_run_bag(bag, [DrawnRun("run_0")])
    assert told(url, tmp_path / "bags") == []
    copy = write_run_bag(tmp_path / "bags" / "b", [DrawnRun("run_0", success=None)], close=False)
    (copy / "metadata.yaml").unlink(missing_ok=True)
    assert told(url, tmp_path / "bags") == []
    with Catalogue(url) as catalogue:
        (row,) = catalogue.rows()
    assert (row.run.success, row.run.bag) == (True, str(bag))


def test_a_run_that_ended_is_not_overwritten_by_one_that_did_not(tmp_path: Path, url: str) -> None:
    """Its end was noted while it was recorded, and never reached the disk."""
    bag = write_run_bag(tmp_path / "bag", [DrawnRun("run_0")])
    assert told(url, bag) == []
    shutil.rmtree(bag)
    write_run_bag(bag, [DrawnRun("run_0", success=None)], close=False)
    assert told(url, bag) == []
    with Catalogue(url) as catalogue:
        (row,) = catalogue.rows()
    assert row.run.success is True
    assert (row.run.bag, bool(row.run.bag_sha256)) == (str(bag), True)
    assert row.run.ended_ns is not None


@pytest.mark.parametrize("share", [0.3, 0.6])
def test_a_bag_with_a_damaged_middle_is_named(tmp_path: Path, share: float) -> None:
    bag = Path(shutil.copytree(ROOT / "bags" / "standard_door", tmp_path / "bag"))
    (path,) = bag.glob("*.mcap")
    data = bytearray(path.read_bytes())
    at = int(len(data) * share)
    data[at : at + 64] = bytes(byte ^ 0xA5 for byte in data[at : at + 64])
    path.write_bytes(data)
    (reason,) = told(str(tmp_path / "catalogue.sqlite"), bag)
    assert str(bag) in reason
    assert bags_of(str(tmp_path / "catalogue.sqlite")) == {}


@pytest.mark.parametrize("left", ["nothing", "an empty folder", "another bag"])
def test_a_renamed_bag_is_found_at_its_new_place(tmp_path: Path, url: str, left: str) -> None:
    old, new = tmp_path / "bags" / "m", tmp_path / "bags" / "b"
    write_run_bag(old, [DrawnRun("run_0")])
    assert told(url, tmp_path / "bags") == []
    old.rename(new)
    if left == "an empty folder":
        old.mkdir()
    if left == "another bag":
        write_run_bag(old, [DrawnRun("run_1")])
    assert told(url, new) == []
    assert bags_of(url) == {"run_0": str(new)}


def test_a_bag_that_is_gone_is_forgotten_and_its_runs_stay(tmp_path: Path, url: str) -> None:
    place = tmp_path / "bags"
    for number in range(3):
        write_run_bag(place / str(number), [DrawnRun(f"run_{number}")])
    write_run_bag(tmp_path / "other", [DrawnRun("run_9")], recorder={**RECORDER, "cell": "larder/cell1"})
    assert told(url, tmp_path) == []
    shutil.rmtree(place / "0")
    shutil.rmtree(tmp_path / "other")
    cut(place / "1", 0.2)
    with Catalogue(url) as catalogue:
        (row,) = [row for row in catalogue.rows() if row.run.run_id == "run_9"]
        # Another machine may have a folder of the same path.
        catalogue.store(str(place / "7"), [replace(row.run, bag=str(place / "7"))])
    assert len(told(url, place)) == 1
    assert bags_of(url) == {
        "run_0": "",
        "run_1": str(place / "1"),
        "run_2": str(place / "2"),
        "run_9": str(place / "7"),
    }


def test_a_place_without_any_bag_makes_no_bag_forgotten(tmp_path: Path, url: str) -> None:
    """As where the disk that belongs there is not mounted."""
    write_run_bag(tmp_path / "bags" / "0", [DrawnRun("run_0")])
    write_run_bag(tmp_path / "others" / "1", [DrawnRun("run_1")])
    assert told(url, tmp_path) == []
    (tmp_path / "bags").rename(tmp_path / "away")
    (tmp_path / "bags").mkdir()
    told(url, tmp_path / "bags", tmp_path / "others")
    assert bags_of(url)["run_0"] == str(tmp_path / "bags" / "0")
