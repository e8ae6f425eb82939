"""Rows as runs end, rows from their bags: the same, whatever was in between."""

from __future__ import annotations

import gc
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import weakref
from math import isfinite
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bags.timeline import load_timeline
from doormill_ros.catalogue.bag_rows import read_rows
from doormill_ros.catalogue.database import Catalogue
from doormill_ros.catalogue.filler import RunFiller
from doormill_ros.catalogue.rebuild import rebuild
from doormill_ros.catalogue.run import CatalogueRow
from doormill_ros.catalogue.run_collector import RunCollector, recipe_digest
from doormill_ros.errors import DoormillError
from doormill_ros.recording.typestores import reader_of
from support.hostile.mutations import mutated
from support.run_bags import (
    RECORDER,
    TYPES,
    DrawnRun,
    decode,
    drawn_runs,
    write_inspection_note,
    write_run_bag,
)
from support.source_tree import ROOT
from support.waiting import LIMIT, until

BAGS = ROOT / "bags"


def filled(url: str, folder: Path, runs: list[DrawnRun], stop: bool = True) -> RunFiller:
    """Record runs while a filler notes them."""
    filler = RunFiller(url, folder, RECORDER, decode)
    filler.start()
    write_run_bag(folder, runs, filler.take, close=stop)
    if stop:
        filler.stop()
    return filler


def filled_in_vain(folder: Path) -> tuple[Path, RunFiller]:
    """Record one run while the catalogue is away: a folder stands where it should be, which is the first part."""
    place = folder / "away"
    place.mkdir()
    filler = RunFiller(str(place), folder / "bag", RECORDER, decode)
    filler.start()
    write_run_bag(folder / "bag", [DrawnRun("run_0")], filler.take)
    return place, filler


def cut_off(filler: RunFiller) -> None:
    """End what notes runs as a killed recorder leaves it: nothing is finished."""
    filler._received.put(None)
    filler._thread.join()


def rows_of(url: str) -> list[CatalogueRow]:
    with Catalogue(url) as catalogue:
        return list(catalogue.rows())


def rebuilt(url: str, *places: Path) -> list[CatalogueRow]:
    with Catalogue(url) as catalogue:
        refused = [found.refused for found in rebuild(catalogue, places) if found.refused]
    assert [text for text in refused if "holds no run" not in text] == []
    return rows_of(url)


def check_row(row: CatalogueRow, drawn: DrawnRun) -> None:
    """Against what was drawn, not against how rows are made."""
    run = row.run
    assert (run.run_id, run.door_id, run.recipe_version) == (drawn.run_id, drawn.door_id, drawn.version)
    assert (run.cell, run.software) == ("oven/cell1", "0.1.0+0123456789ab")
    assert (run.begun_ns, run.success) == (drawn.begun_ns, drawn.success)
    assert run.error_code == (0 if drawn.success is None else drawn.error_code)
    assert run.largest_correction == drawn.correction
    if drawn.success is not None:
        assert (run.measured, run.deviation) == (drawn.deviation is not None, drawn.deviation)
        steps = len(drawn.offsets) + (drawn.correction is not None) + 1
        assert run.ended_ns == drawn.begun_ns + steps * 10**9
    expected = drawn.offsets[-1] if drawn.offsets and isfinite(drawn.offsets[-1]) else None
    assert (run.offset_y, run.x) == (expected, None if expected is None else 2.0 + expected)


@settings(max_examples=8)
@given(st.lists(st.integers(0, 2), max_size=3, unique=True), st.data())
def test_rebuilding_gives_the_rows_that_filling_gave(inspected: list[int], data: st.DataObject) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        drawn = []
        for number in range(2):
            runs = data.draw(drawn_runs(f"run_{number}_"))
            drawn += runs
            for index in set(inspected) & set(range(len(runs))):
                write_inspection_note(folder / f"door_{number}" / "inspection", runs[index].run_id)
            filler = filled(f"{folder}/filled", folder / f"door_{number}" / "bag", runs)
            assert filler.failure == ""
        found = rebuilt(f"{folder}/rebuilt", folder)
        assert found == rows_of(f"{folder}/filled")
        assert rebuilt(f"{folder}/filled", folder) == found
        assert [row.run.run_id for row in found] == [run.run_id for run in drawn]
        by_id = {run.run_id: run for run in drawn}
        checked = [check_row(row, by_id[row.run.run_id]) for row in found]
        assert len(checked) == len(drawn)


def test_a_run_is_there_before_its_bag_is_closed_and_whole_once_it_is_rebuilt(tmp_path: Path) -> None:
    """The recorder is killed: what it noted has no checksum, the bag no end."""
    url, bag = str(tmp_path / "catalogue"), tmp_path / "bag"
    ended, broken_off = DrawnRun("run_0"), DrawnRun("run_1", success=None)
    filler = filled(url, bag, [ended, broken_off], stop=False)
    cut_off(filler)
    (row,) = rows_of(url)
    assert (row.run.run_id, row.run.success, row.run.bag, row.run.bag_sha256) == ("run_0", True, str(bag), "")
    first, second = rebuilt(url, tmp_path)
    assert (first.run.run_id, second.run.run_id, second.run.success) == ("run_0", "run_1", None)
    assert first.run.bag_sha256 == second.run.bag_sha256 != ""


def test_the_bag_is_whole_when_the_catalogue_is_away(tmp_path: Path) -> None:
    """Nothing is lost: the rows come with the bag."""
    filler = filled(str(tmp_path), tmp_path / "bag", [DrawnRun("run_0")])
    assert "catalogue rebuild" in filler.failure
    (row,) = rebuilt(str(tmp_path / "catalogue"), tmp_path)
    assert row.run.run_id == "run_0"


def test_it_catches_up_when_the_catalogue_is_back(tmp_path: Path) -> None:
    place, filler = filled_in_vain(tmp_path)
    place.rmdir()
    filler.stop()
    assert filler.failure == ""
    assert [row.run.run_id for row in rows_of(str(place))] == ["run_0"]


def test_a_database_that_is_silent_holds_no_recorder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It takes the connection and never answers, as a server that was stopped."""
    monkeypatch.setattr("doormill_ros.catalogue.filler.STOP_LIMIT", 0.5)
    monkeypatch.setattr(
        "doormill_ros.recipes.store.engine.POSTGRESQL_ARGUMENTS", {"connect_timeout": int(LIMIT)}
    )
    with socket.create_server(("127.0.0.1", 0)) as silent:
        url = f"postgresql://me:secret@127.0.0.1:{silent.getsockname()[1]}/x"
        filler = filled(url, tmp_path / "bag", [DrawnRun("run_0")])
        # While it is silent: it closes with its socket, which is an answer.
        assert filler._thread.is_alive()
        assert "does not answer" in filler.failure
        assert f"catalogue rebuild {tmp_path / 'bag'} adds them" in filler.failure
        assert "secret" not in filler.failure


def test_it_catches_up_with_the_next_run_while_it_records(tmp_path: Path) -> None:
    place, filler = filled_in_vain(tmp_path)
    until(lambda: filler.failure)
    place.rmdir()
    write_run_bag(tmp_path / "further", [DrawnRun("run_1"), DrawnRun("run_2")], filler.take)
    until(lambda: place.is_file() and len(rows_of(str(place))) == 3)
    assert [row.run.run_id for row in rows_of(str(place))] == ["run_0", "run_1", "run_2"]
    cut_off(filler)


def test_a_run_that_ends_is_noted_without_those_before_it(tmp_path: Path) -> None:
    """A recorder sees hundreds of runs: the last costs what the first did, and no message is kept."""
    messages: list[weakref.ref[Any]] = []
    collector = RunCollector(RECORDER)

    def take(topic: str, data: bytes, stamp_ns: int) -> None:
        message = reader_of(f"doormill_interfaces/msg/{TYPES[topic].__name__}")(data)
        messages.append(weakref.ref(message))
        if collector.take(topic, message, stamp_ns):
            noted.append([run.run_id for run in collector.runs(touched=True)])
            collector.noted()

    noted: list[list[str]] = []
    write_run_bag(tmp_path / "bag", [DrawnRun(f"run_{number}") for number in range(4)], take)
    assert noted == [["run_0"], ["run_1"], ["run_2"], ["run_3"]]
    gc.collect()
    assert len(messages) > len(noted)
    assert [message for message in messages if message() is not None] == []
    assert [run.run_id for run in collector.runs()] == ["run_0", "run_1", "run_2", "run_3"]


def test_a_recording_in_place_of_another_takes_its_runs_from_the_bag(tmp_path: Path) -> None:
    """The one before was killed, and its bag removed by hand."""
    url, bag = str(tmp_path / "catalogue"), tmp_path / "bag"
    for name in ("run_0", "run_1"):
        filler = filled(url, bag, [DrawnRun(name)], stop=False)
        cut_off(filler)
        shutil.rmtree(bag)
    assert [(row.run.run_id, row.run.bag) for row in rows_of(url)] == [("run_0", ""), ("run_1", str(bag))]


def test_a_message_that_nobody_foresaw_costs_no_later_run(tmp_path: Path) -> None:
    taken: list[str] = []

    def stumble(topic: str, data: bytes) -> Any:
        taken.append(topic)
        if len(taken) == 1:
            raise ZeroDivisionError("nobody foresaw it")
        return decode(topic, data)

    place = tmp_path / "catalogue"
    filler = RunFiller(str(place), tmp_path / "bag", RECORDER, stumble)
    filler.start()
    write_run_bag(tmp_path / "bag", [DrawnRun("run_0"), DrawnRun("run_1")], filler.take)
    filler.stop()
    assert len(taken) > 1
    assert filler.failure == ""
    assert "run_1" in [row.run.run_id for row in rows_of(str(place))]


def test_the_reference_bags_give_what_their_timeline_says(tmp_path: Path) -> None:
    _, scenarios = load_timeline(BAGS / "timeline.yaml")
    found = {Path(row.run.bag).name: row.run for row in rebuilt(str(tmp_path / "catalogue"), BAGS)}
    assert len(found) == len(scenarios) >= 12
    said = {s.name: (s.door, s.success) for s in scenarios}
    assert said == {name: (run.door_id, run.success) for name, run in found.items()}
    codes = {s.name: s.error_codes for s in scenarios if not s.success}
    assert {n for n, (first, last) in codes.items() if not first <= found[n].error_code <= last} == set()
    hinge, standard = found["thesis_190_0deg"], found["standard_door"]
    assert (hinge.software, hinge.model_version) == ("", "0")
    assert hinge.robot_model == standard.robot_model != ""
    assert hinge.recipe_digest != standard.recipe_digest
    assert abs(sum(getattr(hinge, name) ** 2 for name in ("qx", "qy", "qz", "qw")) - 1.0) < 1e-9
    assert found["unknown_door"].recipe_digest == ""


def test_a_recipe_has_one_digest_whoever_saved_it_when() -> None:
    one = '{"door_id": "a", "width_mm": 800, "version": 1, "author": "anna", "created": "2026-01-01"}'
    assert recipe_digest(one) == recipe_digest(
        '{"width_mm": 800, "door_id": "a", "version": 2, "author": "bob"}'
    )
    assert recipe_digest(one) != recipe_digest(one.replace("800", "801"))
    assert len({recipe_digest(text) for text in ("", "[]", "no JSON", "[" * 9999)}) == 4


def test_an_inspection_that_lies_elsewhere_is_found_by_the_name_of_its_run(tmp_path: Path) -> None:
    write_run_bag(tmp_path / "bags" / "one", [DrawnRun("run_0"), DrawnRun("run_1")])
    note = write_inspection_note(tmp_path / "gauge" / "17", "run_1")
    first, second = rebuilt(str(tmp_path / "catalogue"), tmp_path / "gauge", tmp_path / "bags")
    assert first.inspection is None
    assert second.inspection is not None
    assert second.inspection.inspection == str(note)
    assert second.inspection.inspected_ns == 1795334400 * 10**9


@pytest.mark.parametrize("name", ["", "a\nb", "x" * 201])
def test_a_run_that_no_catalogue_can_hold_is_named_and_keeps_no_other_out(tmp_path: Path, name: str) -> None:
    write_run_bag(tmp_path / "a", [DrawnRun(name), DrawnRun("run_1")])
    write_run_bag(tmp_path / "b", [DrawnRun("run_2")])
    with Catalogue(str(tmp_path / "catalogue")) as catalogue:
        first, second = rebuild(catalogue, [tmp_path])
        assert (first.runs, second.runs, second.refused) == (1, 1, "")
        assert f"found the run {name!r}, allowed are 1 to 200 printable" in first.refused
        assert [row.run.run_id for row in catalogue.rows()] == ["run_1", "run_2"]


def test_hostile_bags_keep_no_other_out(tmp_path: Path) -> None:
    """Seeded damage; each one is read or named, and the sound ones are there."""
    good = BAGS / "unknown_door"
    mcap = next(good.glob("*.mcap"))
    for seed in range(24):
        bag = Path(shutil.copytree(good, tmp_path / f"bad_{seed:02d}"))
        path = bag / random.Random(seed).choice([mcap.name, "metadata.yaml"])
        path.write_bytes(mutated(path.read_bytes(), random.Random(seed)))
    (tmp_path / "bad_folder" / "x_0.mcap").mkdir(parents=True)
    write_run_bag(tmp_path / "a_good", [DrawnRun("run_0")])
    write_run_bag(tmp_path / "z_good", [DrawnRun("run_1")])
    with Catalogue(str(tmp_path / "catalogue")) as catalogue:
        told = {found.path.name: found for found in rebuild(catalogue, [tmp_path])}
        stored = {row.run.run_id for row in catalogue.rows()}
    assert len(told) == 27
    assert {"run_0", "run_1"} <= stored
    refused = [name for name, found in told.items() if found.refused]
    assert len(refused) >= 10
    assert {name for name in refused if "good" in name} == set()


KILLED = """
import os, signal, sys
import sqlalchemy as sa
from pathlib import Path
from doormill_ros.catalogue.database import Catalogue
from doormill_ros.catalogue.rebuild import rebuild

url, folder, count = sys.argv[1], Path(sys.argv[2]), int(sys.argv[3])
with Catalogue(url) as catalogue:
    @sa.event.listens_for(catalogue._engine, "after_cursor_execute")
    def die(*_):
        global count
        count -= 1
        if count == 0:
            os.kill(os.getpid(), signal.SIGKILL)
    list(rebuild(catalogue, [folder]))
"""


def test_a_fill_that_is_killed_leaves_whole_bags_and_is_taken_up_again(tmp_path: Path) -> None:
    for number in range(4):
        runs = [DrawnRun(f"run_{number}_{index}") for index in range(3)]
        write_run_bag(tmp_path / "bags" / f"bag_{number}", runs)
    wanted = rebuilt(str(tmp_path / "whole"), tmp_path / "bags")
    assert len(wanted) == 12
    # Each bag takes BEGIN, one look and one row a run, one update; the seed says where in between.
    for seed in (3, 4):
        count = random.Random(seed).randrange(9, 30)
        url = str(tmp_path / f"killed_{seed}")
        command = [sys.executable, "-c", KILLED, url, str(tmp_path / "bags"), str(count)]
        assert subprocess.run(command, timeout=LIMIT, check=False).returncode == -signal.SIGKILL
        left = rows_of(url)
        assert 0 < len(left) < 12
        assert len(left) % 3 == 0
        assert left == wanted[: len(left)]
        assert rebuilt(url, tmp_path / "bags") == wanted


def test_an_inspection_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    bag = write_run_bag(tmp_path / "bag", [DrawnRun("run_0")])
    write_inspection_note(tmp_path / "inspection", "run_0", measured_at="soon")
    rows = read_rows(bag)
    assert rows.inspections == ()
    assert "measured_at 'soon'" in rows.refused
    with Catalogue(str(tmp_path / "catalogue")) as catalogue:
        told = [found.refused for found in rebuild(catalogue, [tmp_path])]
    assert len([text for text in told if "measured_at" in text]) == 2
    with pytest.raises(DoormillError):
        read_rows(tmp_path / "nothing")


def inspected(url: str, *places: Path) -> dict[str, str]:
    """The folder's name of each inspected run."""
    rows = rebuilt(url, *places)
    return {row.run.run_id: Path(row.inspection.inspection).name for row in rows if row.inspection}


def test_a_run_id_that_was_put_right_leaves_the_other_run_without_inspection(
    tmp_path: Path, url: str
) -> None:
    write_run_bag(tmp_path / "bags" / "one", [DrawnRun("run_0"), DrawnRun("run_1")])
    write_inspection_note(tmp_path / "gauge" / "17", "run_1")
    assert inspected(url, tmp_path) == {"run_1": "17"}
    write_inspection_note(tmp_path / "gauge" / "17", "run_0")
    assert inspected(url, tmp_path / "gauge") == {"run_0": "17"}
    assert inspected(url, tmp_path) == {"run_0": "17"}


def test_an_inspection_that_is_gone_is_forgotten_once_its_place_is_rebuilt(tmp_path: Path, url: str) -> None:
    write_run_bag(tmp_path / "bags" / "one", [DrawnRun("run_0"), DrawnRun("run_1"), DrawnRun("run_2")])
    for number in range(3):
        write_inspection_note(tmp_path / "gauge" / str(number), f"run_{number}")
    everything = {"run_0": "0", "run_1": "1", "run_2": "2"}
    assert inspected(url, tmp_path) == everything
    shutil.rmtree(tmp_path / "gauge" / "0")
    (tmp_path / "gauge" / "2" / "inspection.yaml").write_text("run_id: [")
    assert inspected(url, tmp_path / "bags") == everything  # of another place it tells nothing
    with Catalogue(url) as catalogue:
        list(rebuild(catalogue, [tmp_path / "gauge"]))
        rows = list(catalogue.rows())
    assert [row.run.run_id for row in rows if row.inspection] == ["run_1", "run_2"]  # who knows what it says


def test_a_place_that_holds_nothing_makes_nothing_forgotten(tmp_path: Path, url: str) -> None:
    """As where the disk that belongs there is not mounted."""
    write_run_bag(tmp_path / "bags" / "one", [DrawnRun("run_0")])
    write_inspection_note(tmp_path / "gauge" / "0", "run_0")
    assert inspected(url, tmp_path) == {"run_0": "0"}
    (tmp_path / "gauge").rename(tmp_path / "away")
    (tmp_path / "gauge").mkdir()
    with Catalogue(url) as catalogue:
        list(rebuild(catalogue, [tmp_path / "gauge"]))
        assert [row.inspection is not None for row in catalogue.rows()] == [True]


def test_inspections_of_another_machine_stay(tmp_path: Path, url: str) -> None:
    """It may have a folder of the same path, which nobody here can look into."""
    write_run_bag(tmp_path / "bags" / "one", [DrawnRun("run_0")])
    other = {**RECORDER, "cell": "larder/cell1"}
    write_run_bag(tmp_path / "other", [DrawnRun("run_1")], recorder=other)
    write_inspection_note(tmp_path / "gauge" / "0", "run_1")
    assert inspected(url, tmp_path / "gauge", tmp_path / "other") == {"run_1": "0"}
    write_inspection_note(tmp_path / "gauge" / "0", "run_0")
    assert inspected(url, tmp_path / "gauge", tmp_path / "bags") == {"run_0": "0", "run_1": "0"}
    (tmp_path / "gauge" / "0").rename(tmp_path / "gauge" / "1")
    assert inspected(url, tmp_path / "gauge", tmp_path / "bags") == {"run_0": "1", "run_1": "0"}
