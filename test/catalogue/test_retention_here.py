"""Which bags lie here at all: those of other machines, behind links, or that cannot be moved."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from doormill_ros.catalogue import retention
from doormill_ros.catalogue.database import Catalogue
from doormill_ros.catalogue.rebuild import rebuild
from doormill_ros.catalogue.retention import Retention, judge, retain
from doormill_ros.tools.catalogue import main
from support.run_bags import BEGUN_NS, DAY_NS, DrawnRun, write_inspection_note, write_run_bag

NOW_NS = BEGUN_NS + 100 * DAY_NS


@pytest.fixture
def catalogue(tmp_path: Path) -> Iterator[Catalogue]:
    with Catalogue(str(tmp_path / "catalogue.sqlite")) as opened:
        yield opened


def make(catalogue: Catalogue, place: Path, *days: int) -> list[Path]:
    """A catalogued bag a day, `run_<day>` in `<day>/bag`."""
    bags = [
        write_run_bag(place / str(day) / "bag", [DrawnRun(f"run_{day}", begun_ns=BEGUN_NS + day * DAY_NS)])
        for day in days
    ]
    assert [found.refused for found in rebuild(catalogue, [place]) if found.refused] == []
    return bags


def going(catalogue: Catalogue, **limits: float) -> list[str]:
    return [one.bag.parent.name for one in judge(catalogue, Retention(**limits), NOW_NS) if one.goes]


@pytest.mark.parametrize("sha256", ["ab" * 32, ""])
def test_rows_of_another_machine_with_the_same_path_count_nothing(
    catalogue: Catalogue, tmp_path: Path, sha256: str
) -> None:
    make(catalogue, tmp_path, 0, 1, 2)
    rows = [row.run for row in catalogue.rows()]
    total = sum(run.bag_bytes for run in rows)
    for run in rows:
        other = replace(run, run_id=f"other_{run.run_id}", cell="larder/cell1", bag_sha256=sha256)
        catalogue.store(run.bag, [replace(other, bag_bytes=run.bag_bytes if sha256 else 0)])
    assert going(catalogue, gigabytes=(total + 1) / 1e9) == []
    assert going(catalogue, gigabytes=total * 0.999 / 1e9) == ["0"]
    judged = judge(catalogue, Retention(gigabytes=0), NOW_NS)
    assert [one.bag.parent.name for one in judged if one.goes] == ["0", "1", "2"]
    assert len(judged) == 3


def test_a_bag_behind_a_link_anywhere_in_its_path_stays_and_it_is_said(
    catalogue: Catalogue, tmp_path: Path
) -> None:
    make(catalogue, tmp_path / "place" / "bags", 0)
    (tmp_path / "place").rename(tmp_path / "archive")
    (tmp_path / "place").symlink_to(tmp_path / "archive")
    found = list(retain(catalogue, Retention(days=0), NOW_NS))
    assert [(one.goes, one.reason) for one in found] == [(False, "it lies behind a link")]
    assert (tmp_path / "archive" / "bags" / "0" / "bag").is_dir()


def test_a_broken_off_deletion_behind_a_link_is_left_alone(catalogue: Catalogue, tmp_path: Path) -> None:
    (bag,) = make(catalogue, tmp_path / "place", 0)
    bag.rename(bag.with_name(".bag.retired"))
    (tmp_path / "place").rename(tmp_path / "archive")
    (tmp_path / "place").symlink_to(tmp_path / "archive")
    assert list(retain(catalogue, Retention(days=0), NOW_NS)) == []
    assert (tmp_path / "archive" / "0" / ".bag.retired").is_dir()


def test_an_inspection_behind_a_link_near_the_bag_keeps_it(catalogue: Catalogue, tmp_path: Path) -> None:
    make(catalogue, tmp_path / "bags", 0, 1, 2)
    write_inspection_note(tmp_path / "gauge" / "first", "run_0")
    write_inspection_note(tmp_path / "gauge" / "second" / "deep", "run_1")
    (tmp_path / "bags" / "0" / "gauge").symlink_to(tmp_path / "gauge" / "first")
    (tmp_path / "bags" / "1" / "gauge").symlink_to(tmp_path / "gauge" / "second")
    # Links that lead round in a circle, or nowhere, end nothing.
    (tmp_path / "bags" / "2" / "round").symlink_to(tmp_path / "bags")
    (tmp_path / "bags" / "2" / "nowhere").symlink_to(tmp_path / "nothing")
    assert going(catalogue, days=0) == ["2"]


def test_a_bag_that_cannot_be_moved_stops_no_other(
    catalogue: Catalogue,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    bags = make(catalogue, tmp_path / "bags", 0, 1, 2)
    rename = Path.rename

    def refused(path: Path, target: Path) -> Path:
        if path == bags[1]:
            raise PermissionError(13, "Permission denied", str(path))
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", refused)
    command = ["--database", str(tmp_path / "catalogue.sqlite"), "retain", "--days", "0"]
    assert main([*command, "--inspections", str(tmp_path / "bags")]) == 1
    said = capsys.readouterr()
    assert [bag.exists() for bag in bags] == [False, True, False]
    assert "2 bags" in said.out
    assert f"catalogue: bag {bags[1]} stays: it cannot be deleted: Permission denied" in said.err


def test_a_bag_that_cannot_be_read_stops_no_other(
    catalogue: Catalogue, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bags = make(catalogue, tmp_path / "bags", 0, 1)
    content = retention.content_of_bag

    def refused(folder: Path):
        if folder == bags[0]:
            raise OSError(5, "Input/output error", str(folder))
        return content(folder)

    monkeypatch.setattr(retention, "content_of_bag", refused)
    first, second = retain(catalogue, Retention(days=0), NOW_NS)
    assert (first.goes, first.failed, second.goes) == (False, True, True)
    assert "Input/output error" in first.reason


def test_what_a_broken_off_deletion_left_and_cannot_be_deleted_stops_nothing(
    catalogue: Catalogue, tmp_path: Path
) -> None:
    bags = make(catalogue, tmp_path / "bags", 0, 1)
    retired = bags[0].rename(bags[0].with_name(".bag.retired"))
    (retired / "folder").mkdir()
    found = list(retain(catalogue, Retention(days=0), NOW_NS))
    assert [(one.bag, one.goes, one.failed) for one in found] == [
        (bags[0], False, True),
        (bags[1], True, False),
    ]
    shutil.rmtree(retired / "folder")
    assert list(retain(catalogue, Retention(days=0), NOW_NS)) == []
    assert not retired.exists()


def test_to_delete_many_costs_no_look_round_for_each(
    catalogue: Catalogue, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    count = 4 * retention.LOOKS
    (bag,) = make(catalogue, tmp_path, 0)
    (row,) = catalogue.rows()
    for number in range(1, count):
        copy = Path(shutil.copytree(bag, tmp_path / str(number) / "bag"))
        catalogue.store(str(copy), [replace(row.run, run_id=f"run_{number}", bag=str(copy))])
    looks, walk = [], os.walk
    monkeypatch.setattr(os, "walk", lambda top, *args, **more: looks.append(top) or walk(top, *args, **more))
    gone = [one for one in retain(catalogue, Retention(days=0), NOW_NS) if one.goes]
    assert len(gone) == count
    assert len(looks) <= count * (retention.LOOKS + 2)
