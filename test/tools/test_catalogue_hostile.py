"""`catalogue` with times out of range, names that are no text, and names that would break its lines."""

from __future__ import annotations

import os
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from doormill_ros.catalogue.database import ENVIRONMENT, Catalogue
from doormill_ros.recipes.store import engine
from doormill_ros.tools.catalogue import main
from support.run_bags import DrawnRun, write_inspection_note, write_run_bag

NO_TEXT = os.fsdecode(b"bad\xff")


@pytest.fixture
def url(tmp_path: Path) -> str:
    for number in range(2):
        write_run_bag(tmp_path / "bags" / str(number) / "bag", [DrawnRun(f"run_{number}")])
    database = str(tmp_path / "catalogue.sqlite")
    assert main(["--database", database, "rebuild", str(tmp_path / "bags")]) == 0
    return database


@pytest.mark.parametrize(
    ("option", "listed"),
    [
        (["--since", "0001-01-01"], 2),
        (["--since", "9999-12-31"], 0),
        (["--until", "0001-01-01"], 0),
        (["--until", "9999-12-31T23:59:59"], 2),
    ],
)
def test_times_before_and_behind_all_others(
    url: str, option: list[str], listed: int, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    assert main(["--database", url, "list", *option]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 1 + listed


@pytest.mark.parametrize("limit", ["--days", "--gigabytes"])
def test_a_limit_that_nothing_reaches_lets_everything_stay(
    url: str, tmp_path: Path, limit: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["--database", url, "retain", limit, "1e300", "--inspections", str(tmp_path)]) == 0
    assert "0 bags with 0.000 GB went, 2 stay" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments",
    [["keep", "run_0", "--reason", NO_TEXT], ["keep", NO_TEXT], ["list", "--door", NO_TEXT]],
)
def test_what_is_no_text_is_refused_in_a_line(
    url: str, arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    with pytest.raises(SystemExit) as ended:
        main(["--database", url, *arguments])
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert "found 'bad\\udcff', allowed is text in UTF-8" in said
    assert len(said.splitlines()) == 1


def test_folders_whose_names_are_no_text_are_named_and_keep_no_other_out(
    url: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    place = tmp_path / NO_TEXT
    write_inspection_note(place / "gauge", "run_0")
    write_inspection_note(tmp_path / "gauge", "run_1")
    for folder in (place, tmp_path):
        capsys.readouterr()
        assert main(["--database", url, "rebuild", str(folder)]) == 1
        said = capsys.readouterr().err
        assert "bad\\udcff" in said
        assert "rename the folder" in said
        assert len(said.splitlines()) == 1
    with Catalogue(url) as catalogue:
        assert [row.run.run_id for row in catalogue.rows() if row.inspection] == ["run_1"]


def test_names_break_no_line(url: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    strange = tmp_path / "bags" / "a\tb\nc\x1b[31m"
    write_run_bag(strange / "bag", [DrawnRun("run_2")])
    assert main(["--database", url, "rebuild", str(tmp_path / "bags")]) == 0
    assert main(["--database", url, "keep", "run_2", "--reason", "one\ttwo\nthree\x1b[0m dør"]) == 0
    capsys.readouterr()
    assert main(["--database", url, "list"]) == 0
    head, *lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 3
    assert {len(line.split("\t")) for line in (head, *lines)} == {13}
    assert "one\\ttwo\\nthree\\x1b[0m dør" in lines[2]
    assert "a\\tb\\nc\\x1b[31m" in lines[2]
    assert (
        main(["--database", url, "retain", "--days", "0", "--dry-run", "--inspections", str(tmp_path)]) == 0
    )
    *lines, _ = capsys.readouterr().out.splitlines()
    assert {len(line.split("\t")) for line in lines} == {5}


def test_a_catalogue_that_the_environment_names_and_is_not_there_is_not_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(ENVIRONMENT, str(tmp_path / "typo.sqlite"))
    assert main(["list"]) == 2
    assert f"there is no database {tmp_path / 'typo.sqlite'}" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
    monkeypatch.delenv(ENVIRONMENT)
    assert main(["list"]) == 0  # of a site that has none yet


def test_a_catalogue_that_another_process_holds_is_not_called_damaged(
    url: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(engine, "BUSY_SECONDS", 0.1)
    with closing(sqlite3.connect(url, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        assert main(["--database", url, "keep", "run_0"]) == 2
    said = capsys.readouterr().err
    assert "locked" in said
    assert "damaged" not in said
    assert "ask again once the process that holds it is done" in said
