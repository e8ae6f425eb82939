"""How long bags stay: what goes, what never does, and what a broken-off deletion leaves."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from doormill_ros.catalogue.database import Catalogue
from doormill_ros.catalogue.errors import BadRetentionError
from doormill_ros.catalogue.rebuild import rebuild
from doormill_ros.catalogue.retention import Judged, Retention, judge, retain
from doormill_ros.tools.catalogue import main
from support.run_bags import BEGUN_NS, DAY_NS, DrawnRun, write_inspection_note, write_run_bag

NOW_NS = BEGUN_NS + 100 * DAY_NS


@pytest.fixture
def catalogue(tmp_path: Path) -> Iterator[Catalogue]:
    with Catalogue(str(tmp_path / "catalogue.sqlite")) as opened:
        yield opened


def make(folder: Path, *days: int) -> list[Path]:
    """A bag a day, `run_<day>` in `<day>/bag`; days count from the first."""
    return [
        write_run_bag(folder / str(day) / "bag", [DrawnRun(f"run_{day}", begun_ns=BEGUN_NS + day * DAY_NS)])
        for day in days
    ]


def fill(catalogue: Catalogue, *places: Path) -> None:
    assert [found.refused for found in rebuild(catalogue, places) if found.refused] == []


def going(catalogue: Catalogue, **limits: float) -> list[str]:
    return [one.bag.parent.name for one in judge(catalogue, Retention(**limits), NOW_NS) if one.goes]


def reasons(catalogue: Catalogue, **limits: float) -> dict[str, str]:
    return {one.bag.parent.name: one.reason for one in judge(catalogue, Retention(**limits), NOW_NS)}


def test_older_bags_go_and_their_runs_stay(catalogue: Catalogue, tmp_path: Path) -> None:
    bags = make(tmp_path, 0, 9, 10, 11, 99)
    fill(catalogue, tmp_path)
    assert going(catalogue, days=90) == ["0", "9"]
    assert all(bag.is_dir() for bag in bags)
    assert [one.goes for one in retain(catalogue, Retention(days=90), NOW_NS)] == [
        True,
        True,
        False,
        False,
        False,
    ]
    assert [bag.exists() for bag in bags] == [False, False, True, True, True]
    assert [path.name for path in bags[0].parent.iterdir()] == []
    rows = {row.run.run_id: row.run for row in catalogue.rows()}
    assert len(rows) == 5
    assert (rows["run_0"].bag, rows["run_0"].bag_bytes, rows["run_0"].door_id) == ("", 0, "door_1")
    assert rows["run_10"].bag == str(bags[2])
    assert list(retain(catalogue, Retention(days=90), NOW_NS)) == judge(catalogue, Retention(days=90), NOW_NS)


def test_the_oldest_go_until_the_others_fit(catalogue: Catalogue, tmp_path: Path) -> None:
    make(tmp_path, 3, 1, 2)
    fill(catalogue, tmp_path)
    sizes = {row.run.run_id: row.run.bag_bytes for row in catalogue.rows()}
    two = (sizes["run_2"] + sizes["run_3"]) / 1e9
    assert going(catalogue, gigabytes=two) == ["1"]
    assert going(catalogue, gigabytes=two * 0.999) == ["1", "2"]
    assert going(catalogue, gigabytes=1.0) == []
    assert going(catalogue, gigabytes=0.0) == ["1", "2", "3"]


def test_what_is_needed_never_goes(catalogue: Catalogue, tmp_path: Path) -> None:
    make(tmp_path, *range(8))
    write_inspection_note(tmp_path / "1" / "inspection", "run_1")
    write_inspection_note(tmp_path / "gauge", "run_2")
    fill(catalogue, tmp_path)
    catalogue.keep(["run_4"], "customer asks")
    # All these came after the catalogue was filled, and nobody can read them.
    (tmp_path / "3" / "bag" / "expected.yaml").write_text("?")
    (tmp_path / "5" / "bag" / "notes.txt").write_text("mine")
    write_inspection_note(tmp_path / "6" / "inspection", "nobody", measured_at="?")
    mcap = next((tmp_path / "7" / "bag").glob("*.mcap"))
    mcap.write_bytes(mcap.read_bytes() + b"more")
    found = reasons(catalogue, days=0)
    assert going(catalogue, days=0, gigabytes=0) == ["0"]
    assert "inspection" in found["1"]
    assert "gauge" in found["2"]
    assert "expected.yaml" in found["3"]
    assert found["4"] == "kept: customer asks"
    assert "notes.txt" in found["5"]
    assert "inspection" in found["6"]
    assert "catalogue rebuild" in found["7"]
    kept = [one.bag.parent.name for one in retain(catalogue, Retention(days=0), NOW_NS) if not one.goes]
    assert kept == ["1", "2", "3", "4", "5", "6", "7"]
    assert sorted(path.parent.name for path in tmp_path.glob("*/bag")) == kept


def test_what_comes_to_be_needed_after_all_were_judged_stays(catalogue: Catalogue, tmp_path: Path) -> None:
    bags = make(tmp_path, *range(5))
    fill(catalogue, tmp_path)
    retained = retain(catalogue, Retention(days=0), NOW_NS)
    assert next(retained).goes
    # The first is gone when somebody hands in a gauge's file, asks to keep a run and writes down an expectation.
    write_inspection_note(tmp_path / "1" / "gauge", "run_1")
    catalogue.keep(["run_2"], "customer asks")
    (bags[3] / "expected.yaml").write_text("?")
    found = {one.bag.parent.name: (one.goes, one.reason) for one in retained}
    assert {name: goes for name, (goes, _) in found.items()} == {
        "1": False,
        "2": False,
        "3": False,
        "4": True,
    }
    assert "the inspection" in found["1"][1]
    assert found["2"][1] == "kept: customer asks"
    assert "expectation" in found["3"][1]
    assert [bag.exists() for bag in bags] == [False, True, True, True, False]


def test_an_inspection_near_the_bag_keeps_it_whatever_its_folder_is_called(
    catalogue: Catalogue, tmp_path: Path
) -> None:
    make(tmp_path, *range(5))
    fill(catalogue, tmp_path)
    write_inspection_note(tmp_path / "0" / "gauge", "run_0")
    write_inspection_note(tmp_path / "1" / "cmm" / "first", "run_11")  # a slip, but its bag is this one
    note = tmp_path / "1" / "cmm" / "first" / "inspection.yaml"
    note.write_text(note.read_text().replace("bag: bag", f"bag: {tmp_path / '1' / 'bag'}"))
    write_inspection_note(tmp_path / "2", "another")
    (tmp_path / "3" / "gauge").mkdir()
    (tmp_path / "3" / "gauge" / "inspection.yaml").write_text("run_id: [")
    found = reasons(catalogue, days=0)
    assert f"{tmp_path / '0' / 'gauge'} needs it" in found["0"]
    assert f"{note.parent} needs it" in found["1"]
    assert f"{tmp_path / '2'} needs it" in found["2"]  # it names the bag
    assert "cannot be read" in found["3"]
    assert going(catalogue, days=0) == ["4"]


def test_inspections_that_lie_elsewhere_keep_their_bags_though_nobody_catalogued_them(
    catalogue: Catalogue, tmp_path: Path
) -> None:
    make(tmp_path / "bags", *range(4))
    fill(catalogue, tmp_path)
    kept = tmp_path / "kept"
    write_inspection_note(kept / "doors" / "run_0", "run_0")
    (kept / "refused" / "run_1").mkdir(parents=True)
    (kept / "refused" / "run_1" / "inspection.yaml").write_bytes(b"\xff")
    gone = [one.bag.parent.name for one in retain(catalogue, Retention(days=0), NOW_NS, [kept]) if one.goes]
    assert gone == ["2", "3"]


@pytest.mark.parametrize("parameters", ["", "/**/model_monitor: {ros__parameters: {inspections: gauged}}\n"])
def test_the_command_asks_where_the_monitor_keeps_inspections(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], parameters: str
) -> None:
    site, url = tmp_path / "site", str(tmp_path / "catalogue.sqlite")
    monkeypatch.setenv("DOORMILL_SITE", str(site))
    make(tmp_path / "bags", 0, 1)
    with Catalogue(url) as catalogue:
        fill(catalogue, tmp_path)
    if parameters:
        (site / "config").mkdir(parents=True)
        (site / "config" / "nodes.yaml").write_text(parameters)
    write_inspection_note(site / ("gauged" if parameters else "out/inspections") / "doors" / "x", "run_0")
    retained = ["--database", url, "retain", "--days", "0"]
    assert main([*retained, "--inspections", str(tmp_path / "nowhere")]) == 2
    assert len(list((tmp_path / "bags").glob("*/bag"))) == 2
    assert main(retained) == 0
    assert "1 stay" in capsys.readouterr().out
    assert [path.parent.name for path in (tmp_path / "bags").glob("*/bag")] == ["0"]


def test_a_bag_stays_while_one_of_its_runs_is_young_or_inspected(
    catalogue: Catalogue, tmp_path: Path
) -> None:
    old, young = DrawnRun("run_a"), DrawnRun("run_b", begun_ns=NOW_NS - DAY_NS)
    write_run_bag(tmp_path / "both" / "bag", [old, young])
    write_run_bag(tmp_path / "old" / "bag", [DrawnRun("run_c"), DrawnRun("run_d")])
    write_inspection_note(tmp_path / "gauge", "run_d")
    fill(catalogue, tmp_path)
    assert going(catalogue, days=90) == []


def test_a_bag_that_is_being_recorded_or_whose_recorder_died_stays(
    catalogue: Catalogue, tmp_path: Path
) -> None:
    (bag,) = make(tmp_path, 0)
    fill(catalogue, tmp_path)
    (row,) = catalogue.rows()
    catalogue.store(str(bag), [replace(row.run, bag_sha256="", bag_bytes=0)])
    assert going(catalogue, days=0) == []


def test_bags_that_nobody_catalogued_or_that_lie_on_another_machine_are_left_alone(
    catalogue: Catalogue, tmp_path: Path
) -> None:
    (bag,) = make(tmp_path / "here", 0)
    (other,) = make(tmp_path / "there", 1)
    fill(catalogue, tmp_path / "there")
    other.rename(tmp_path / "elsewhere")
    assert list(retain(catalogue, Retention(days=0), NOW_NS)) == []
    assert bag.is_dir()
    assert [row.run.bag for row in catalogue.rows()] == [str(other)]


def test_a_linked_bag_is_not_followed(catalogue: Catalogue, tmp_path: Path) -> None:
    (bag,) = make(tmp_path, 0)
    fill(catalogue, tmp_path)
    bag.rename(tmp_path / "moved")
    bag.symlink_to(tmp_path / "moved")
    assert going(catalogue, days=0) == []


@pytest.mark.parametrize("left", ["whole", "part", "nothing"])
def test_a_deletion_that_was_killed_is_finished(catalogue: Catalogue, tmp_path: Path, left: str) -> None:
    bag, young = make(tmp_path, 0, 99)
    fill(catalogue, tmp_path)
    retired = bag.rename(bag.with_name(".bag.retired"))
    for path in {"whole": [], "part": [retired / "metadata.yaml"], "nothing": [*retired.iterdir()]}[left]:
        path.unlink()
    assert [found.path.parent.name for found in rebuild(catalogue, [tmp_path])] == ["99"]
    assert [one.bag for one in retain(catalogue, Retention(days=90), NOW_NS)] == [young]
    assert list(bag.parent.iterdir()) == []
    assert [row.run.bag for row in catalogue.rows()] == ["", str(young)]


def test_no_seeded_shift_loses_what_is_needed(catalogue: Catalogue, tmp_path: Path) -> None:
    """Against a count of its own: oldest first, until the rest fits or nothing more may go."""
    chance = random.Random(5)
    days = chance.sample(range(100), 12)
    make(tmp_path, *days)
    needed = set(chance.sample(days, 4))
    for day in needed:
        write_inspection_note(tmp_path / f"gauge_{day}", f"run_{day}")
    fill(catalogue, tmp_path)
    sizes = {int(row.run.run_id[4:]): row.run.bag_bytes for row in catalogue.rows()}
    allowed = sum(sizes.values()) / 2
    left = dict(sizes)
    for day in sorted(days):
        if sum(left.values()) > allowed and day not in needed:
            del left[day]
    judged: list[Judged] = list(retain(catalogue, Retention(gigabytes=allowed / 1e9), NOW_NS))
    assert {int(one.bag.parent.name) for one in judged if not one.goes} == set(left)
    assert {int(path.parent.name) for path in tmp_path.glob("*/bag")} == set(left) > needed
    assert sum(left.values()) <= allowed


@pytest.mark.parametrize("limits", [{}, {"days": -1.0}, {"days": float("nan")}, {"gigabytes": float("inf")}])
def test_limits_that_nobody_means_are_refused(limits: dict[str, float]) -> None:
    with pytest.raises(BadRetentionError, match="allowed are numbers from 0 on"):
        Retention(**limits)
