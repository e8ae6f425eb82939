"""The bag of an inspection: the one that is named, else the one that the catalogue knows of its run."""

from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.catalogue.database import ENVIRONMENT, Catalogue
from doormill_ros.catalogue.known_bags import known_bag
from doormill_ros.catalogue.run import CataloguedRun
from doormill_ros.cell.output.inspection_files import DESCRIPTION
from doormill_ros.errors import DataSetError
from doormill_ros.measurements.inspections.inspection import inspections_in, read_inspection
from doormill_ros.measurements.inspections.inspection_writer import write_inspection
from doormill_ros.simulation.world.gauge import GaugedPoints

POINTS = GaugedPoints(("hinge_1",), ("wall",), np.zeros((1, 3)), np.eye(3)[:1], np.zeros(1))


@pytest.fixture
def catalogued(tmp_path, monkeypatch):
    """A catalogue that knows the bag of one run, and where that lies."""
    monkeypatch.setenv(ENVIRONMENT, f"sqlite:///{tmp_path / 'runs.sqlite'}")
    bag = tmp_path / "far" / "bag"
    bag.mkdir(parents=True)
    gone = tmp_path / "gone"
    with Catalogue() as catalogue:
        for run_id, folder in (("run-7", bag), ("run-8", gone)):
            run = CataloguedRun(run_id=run_id, cell="c", bag=str(folder), bag_sha256="ab" * 32, bag_bytes=1)
            catalogue.store(str(folder), [run])
    return bag


def inspection(folder: Path, run_id: str, named: str | None) -> Path:
    """An inspection that names a bag, or none."""
    (folder / "bag").mkdir(parents=True)
    write_inspection(folder, folder / "bag", run_id, datetime.now(UTC), 1e-5, POINTS)
    path = folder / DESCRIPTION
    lines = [line for line in path.read_text().splitlines() if not line.startswith("bag:")]
    path.write_text("\n".join([*lines, *([] if named is None else [f"bag: {named}"])]) + "\n")
    return folder


@pytest.mark.parametrize("named", [None, "moved_away"])
def test_a_bag_that_is_not_named_or_not_there_is_found_by_the_run(tmp_path, catalogued, named):
    folder = inspection(tmp_path / "one", "run-7", named)
    assert read_inspection(folder, known_bag).bag == catalogued
    assert [one.bag for one in inspections_in(tmp_path, known_bag)] == [catalogued]


def test_a_bag_that_is_named_and_there_is_the_one(tmp_path, catalogued):
    folder = inspection(tmp_path / "one", "run-7", "bag")
    assert read_inspection(folder, known_bag).bag == folder / "bag"


@pytest.mark.parametrize(("run_id", "named"), [("run-8", None), ("run-9", None), ("run-9", "moved_away")])
def test_a_bag_that_nobody_knows_is_asked_for(tmp_path, catalogued, run_id, named):
    folder = inspection(tmp_path / "one", run_id, named)
    with pytest.raises(DataSetError, match=f"no bag of run '{run_id}' is known to the catalogue"):
        read_inspection(folder, known_bag)


def test_who_only_looks_makes_no_catalogue(tmp_path, monkeypatch):
    monkeypatch.setenv(ENVIRONMENT, f"sqlite:///{tmp_path / 'none.sqlite'}")
    assert known_bag("run-7") is None
    assert not (tmp_path / "none.sqlite").exists()
