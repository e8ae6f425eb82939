"""The bags of inspections that the monitor keeps stay, whatever `catalogue retain` is asked."""

from __future__ import annotations

import shutil
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.catalogue.database import Catalogue
from doormill_ros.catalogue.inspection_notes import InspectionNotes
from doormill_ros.catalogue.rebuild import rebuild
from doormill_ros.catalogue.retention import Retention, judge
from doormill_ros.monitor.kept_doors import DoorPoints
from doormill_ros.monitor.questioner import Questioner
from doormill_ros.monitor.watch import ModelWatch
from doormill_ros.monitor.watch_state import WatchSettings
from support.source_tree import ROOT
from support.waiting import until

SETTINGS = WatchSettings(doors=40, since="", limit=0.0, patience=600.0, model="")
NOW_NS = 4_000_000_000 * 10**9
BAGS = ("standard_door", "thesis_190_0deg")


def points(run_id: str) -> DoorPoints:
    """One point of a hinge."""
    at, place = datetime(2026, 11, 23, 6, tzinfo=UTC), np.zeros((1, 3))
    normal = np.array([[0.0, 0.0, 1.0]])
    return DoorPoints(run_id, at, 1e-5, "camera", ["hinge_1"], ["floor"], place, normal, np.full(1, 1e-4))


class Cell:
    """A watch with its notes, and the catalogue of the bags; nobody is asked."""

    def __init__(self, folder: Path, url: str, bags: Path) -> None:
        self.url, self._kept = url, folder / "kept"
        self.notes = InspectionNotes(url, self._kept, lambda: None)
        asked = Questioner(self._kept, lambda: SETTINGS.patience)
        self.watch = ModelWatch(
            self._kept, bags, folder / "models", lambda: SETTINGS, asked, lambda: None, self.notes.note
        )

    def __enter__(self) -> Cell:
        self.watch.start()
        self.notes.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.watch.stop()
        self.notes.stop()

    def staying(self) -> set[str]:
        """Names of the bags that would not go."""
        with Catalogue(self.url) as catalogue:
            return {one.bag.name for one in judge(catalogue, Retention(days=0), NOW_NS) if not one.goes}

    def noted(self) -> dict[str, str]:
        """Where the inspection of each run lies in the monitor's folder."""
        with Catalogue(self.url) as catalogue:
            rows = [row.inspection for row in catalogue.rows() if row.inspection is not None]
        return {row.run_id: str(Path(row.inspection).relative_to(self._kept)) for row in rows}


@pytest.fixture
def recorded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[str, dict[str, str]]:
    """A catalogue of bags, and the run of each bag's name."""
    monkeypatch.setattr(Questioner, "ask", lambda *_: None)
    url = str(tmp_path / "catalogue.sqlite")
    for name in BAGS:
        shutil.copytree(ROOT / "bags" / name, tmp_path / "bags" / name)
        (tmp_path / "bags" / name / "expected.yaml").unlink(missing_ok=True)
    with Catalogue(url) as catalogue:
        assert [found.refused for found in rebuild(catalogue, [tmp_path / "bags"]) if found.refused] == []
        runs = {Path(row.run.bag).name: row.run.run_id for row in catalogue.rows()}
    return url, runs


def test_a_bag_stays_once_its_door_was_gauged(tmp_path: Path, recorded: tuple[str, dict[str, str]]) -> None:
    url, runs = recorded
    with Cell(tmp_path, url, tmp_path / "bags") as cell:
        assert cell.staying() == set()
        cell.watch.take(points(runs[BAGS[0]]))
        until(lambda: cell.staying() == {BAGS[0]})
        assert cell.noted() == {runs[BAGS[0]]: f"doors/{runs[BAGS[0]]}"}


def test_a_bag_stays_while_its_inspection_waits_and_where_it_was_refused(
    tmp_path: Path, recorded: tuple[str, dict[str, str]]
) -> None:
    url, runs = recorded
    run_id = runs[BAGS[1]]
    with Cell(tmp_path, url, tmp_path / "later") as cell:
        cell.watch.take(points(run_id))
        until(lambda: cell.noted() == {run_id: f"waiting/{run_id}"})
        assert cell.staying() == {BAGS[1]}
        shutil.copytree(tmp_path / "bags", tmp_path / "later")
        until(lambda: cell.noted() == {run_id: f"doors/{run_id}"})
        cell.watch._kept.refuse(run_id, "of no use")
        cell.notes.note(run_id)
        until(lambda: cell.noted() == {run_id: f"refused/{run_id}"})
        assert cell.staying() == {BAGS[1]}


def test_what_was_kept_before_is_noted_at_the_start(
    tmp_path: Path, recorded: tuple[str, dict[str, str]]
) -> None:
    url, runs = recorded
    with Cell(tmp_path, str(tmp_path / "another.sqlite"), tmp_path / "bags") as cell:
        cell.watch.take(points(runs[BAGS[0]]))
        until(lambda: len(cell.watch.state().doors) == 1)
    with Cell(tmp_path, url, tmp_path / "bags") as cell:
        until(lambda: cell.staying() == {BAGS[0]})
        assert cell.noted() == {runs[BAGS[0]]: f"doors/{runs[BAGS[0]]}"}


def test_a_catalogue_that_is_away_is_said_and_gets_the_notes_when_it_is_back(
    tmp_path: Path, recorded: tuple[str, dict[str, str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("doormill_ros.catalogue.inspection_notes.RETRY", 0.1)
    url, runs = recorded
    away = Path(url).rename(tmp_path / "away")
    Path(url).mkdir()
    with Cell(tmp_path, url, tmp_path / "bags") as cell:
        cell.watch.take(points(runs[BAGS[0]]))
        until(lambda: "inspections are not in the catalogue" in cell.notes.failure)
        Path(url).rmdir()
        away.rename(url)
        until(lambda: cell.notes.failure == "")
        until(lambda: cell.noted() == {runs[BAGS[0]]: f"doors/{runs[BAGS[0]]}"})
        assert cell.staying() == {BAGS[0]}
