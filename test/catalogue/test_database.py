"""The catalogue's database, each test on SQLite and on a real PostgreSQL."""

from __future__ import annotations

import random
import shutil
import threading
from dataclasses import replace
from pathlib import Path

import pytest
import sqlalchemy as sa

from doormill_ros.catalogue import database
from doormill_ros.catalogue.database import ENVIRONMENT, Catalogue, Selection
from doormill_ros.catalogue.errors import CatalogueTooNewError, CatalogueUnreachableError, UnknownRunError
from doormill_ros.catalogue.run import CataloguedInspection, CataloguedRun
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.recording.bag_folders import content_of_bag

RUN = CataloguedRun(
    run_id="run_1",
    door_id="dør_1",
    cell="oven/cell1",
    software="0.1.0+0123456789ab",
    recipe_version=2**32 - 1,
    begun_ns=2**63 - 1,
    ended_ns=0,
    success=False,
    error_code=65535,
    message="a 'quoted' sentence; DROP TABLE catalogue_run",
    x=0.1 + 0.2,
    y=-0.0,
    qw=5e-324,
    deviation=1.7976931348623157e308,
    bag="/bags/a",
    bag_sha256="ab" * 32,
    bag_bytes=2**40,
)


def ids(catalogue: Catalogue, **wanted: object) -> list[str]:
    return [row.run.run_id for row in catalogue.rows(Selection(**wanted))]  # type: ignore[arg-type]  # names its fields


def test_a_row_comes_back_as_it_was_stored(catalogue: Catalogue) -> None:
    catalogue.store(RUN.bag, [RUN])
    (row,) = catalogue.rows()
    assert row.run == RUN
    assert (row.inspection, row.kept) == (None, "")


def test_a_row_outlives_the_process_and_is_replaced(url: str) -> None:
    with Catalogue(url) as first:
        first.store(RUN.bag, [replace(RUN, success=None)])
    with Catalogue(url) as second:
        second.store(RUN.bag, [RUN])
        assert [row.run for row in second.rows()] == [RUN]


def test_a_bag_recorded_in_the_place_of_another_takes_it_from_the_runs_of_its_cell(
    catalogue: Catalogue,
) -> None:
    elsewhere = replace(RUN, run_id="run_2", cell="another")
    catalogue.store(RUN.bag, [RUN])
    catalogue.store(RUN.bag, [elsewhere])
    later = replace(RUN, run_id="run_3", bag_sha256="cd" * 32)
    catalogue.store(RUN.bag, [later])
    found = {row.run.run_id: row.run for row in catalogue.rows()}
    assert found == {
        "run_1": replace(RUN, bag="", bag_sha256="", bag_bytes=0),
        "run_2": elsewhere,
        "run_3": later,
    }


def test_a_copy_of_a_bag_does_not_take_the_run_away_while_the_first_is_there(
    catalogue: Catalogue, tmp_path: Path
) -> None:
    (tmp_path / "first").mkdir()
    (tmp_path / "first" / "first_0.mcap").write_bytes(b"a bag")
    sha256 = content_of_bag(tmp_path / "first").sha256
    first, copy = (replace(RUN, bag=str(tmp_path / name), bag_sha256=sha256) for name in ("first", "copy"))
    catalogue.store(first.bag, [first])
    catalogue.store(copy.bag, [copy])
    assert [row.run.bag for row in catalogue.rows()] == [first.bag]
    shutil.rmtree(first.bag)
    catalogue.store(copy.bag, [copy])
    assert [row.run.bag for row in catalogue.rows()] == [copy.bag]


def test_the_latest_inspection_of_a_run_is_told_whatever_came_first(catalogue: Catalogue) -> None:
    late, early = CataloguedInspection("run_1", "/a", 2), CataloguedInspection("run_1", "/b", 1)
    catalogue.store("", (), [late])
    catalogue.store(RUN.bag, [RUN], [early])
    catalogue.store(RUN.bag, [RUN])
    (row,) = catalogue.rows()
    assert row.inspection == late


def test_what_is_kept_stays_kept_until_it_is_released(catalogue: Catalogue) -> None:
    catalogue.store(RUN.bag, [RUN])
    catalogue.keep(["run_1"], "customer asks")
    catalogue.store(RUN.bag, [RUN])
    assert [row.kept for row in catalogue.rows()] == ["customer asks"]
    catalogue.keep(["run_1"], "")
    assert [row.kept for row in catalogue.rows()] == [""]


@pytest.mark.parametrize("name", ["nothing", "", "run_1\x00", "'; --"])
def test_keeping_unknown_runs_keeps_none(catalogue: Catalogue, name: str) -> None:
    catalogue.store(RUN.bag, [RUN])
    with pytest.raises(UnknownRunError, match="catalogue list"):
        catalogue.keep(["run_1", name], "why")
    assert [row.kept for row in catalogue.rows()] == [""]


def test_runs_are_selected(catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(database, "PAGE", 2)  # several pages
    runs = [
        CataloguedRun(f"run_{n}", f"door_{n % 2}", begun_ns=n, success=(True, False, None)[n % 3])
        for n in range(7)
    ]
    catalogue.store("", runs)
    everything = [run.run_id for run in runs]
    assert ids(catalogue) == everything
    assert ids(catalogue, door_id="door_1") == ["run_1", "run_3", "run_5"]
    assert ids(catalogue, since_ns=2, until_ns=5) == ["run_2", "run_3", "run_4"]
    assert ids(catalogue, failed=True) == ["run_1", "run_2", "run_4", "run_5"]
    assert ids(catalogue, run_id="run_6") == ["run_6"]


def test_several_writers_lose_nothing(url: str) -> None:
    """They open the empty database at once and write the same runs in different orders, and others."""
    faults: list[BaseException] = []
    common = [CataloguedRun(f"common_{n}", bag="/bags/common") for n in range(20)]

    def write(seed: int) -> None:
        chance = random.Random(seed)
        try:
            with Catalogue(url) as catalogue:
                for turn in range(10):
                    catalogue.store("/bags/common", chance.sample(common, len(common)))
                    catalogue.store(
                        f"/bags/{seed}", [CataloguedRun(f"own_{seed}_{n}") for n in range(turn + 1)]
                    )
        except BaseException as error:
            faults.append(error)

    threads = [threading.Thread(target=write, args=(seed,)) for seed in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert faults == []
    with Catalogue(url) as catalogue:
        found = [row.run for row in catalogue.rows()]
    assert [run for run in found if run.run_id.startswith("common")] == sorted(
        common, key=lambda run: run.run_id
    )
    assert len(found) == 20 + 4 * 10


def test_it_stands_in_one_database_with_the_recipes(url: str) -> None:
    with RecipeDatabase(url) as recipes, Catalogue(url) as catalogue:
        recipes.add_shipped()
        catalogue.store(RUN.bag, [RUN])
    with RecipeDatabase(url) as recipes, Catalogue(url) as catalogue:
        assert len(recipes.list()) > 4
        assert ids(catalogue) == ["run_1"]


def test_another_release_is_told(url: str) -> None:
    with Catalogue(url) as catalogue, catalogue._engine.begin() as connection:
        connection.execute(sa.text("UPDATE catalogue_version SET version = 2"))
    with pytest.raises(CatalogueTooNewError, match="version 2, allowed is 1"):
        Catalogue(url)


@pytest.mark.parametrize("left", [0.0, 0.3, 0.9])
def test_a_torn_file_is_refused_or_read_never_more(tmp_path: Path, left: float) -> None:
    path = tmp_path / "catalogue.sqlite"
    with Catalogue(str(path)) as catalogue:
        catalogue.store("", [CataloguedRun(f"run_{n}", message="x" * 500) for n in range(100)])
    content = path.read_bytes()
    path.write_bytes(
        bytes(100) + content[100 : int(len(content) * left)] if left else b"no database at all" * 100
    )
    with (
        pytest.raises(CatalogueUnreachableError, match="catalogue rebuild DIR"),
        Catalogue(str(path)) as catalogue,
    ):
        list(catalogue.rows())


def test_a_file_cut_off_at_its_end_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "catalogue.sqlite"
    with Catalogue(str(path)) as catalogue:
        catalogue.store("", [CataloguedRun(f"run_{n}", message="x" * 500) for n in range(100)])
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 8192 * 4096])
    with pytest.raises(CatalogueUnreachableError, match="malformed"), Catalogue(str(path)) as catalogue:
        list(catalogue.rows())


def test_nobody_at_the_address(tmp_path: Path) -> None:
    with pytest.raises(CatalogueUnreachableError, match=r"127\.0\.0\.1"):
        Catalogue("postgresql://me:secret@127.0.0.1:1/x")
    (tmp_path / "file").write_text("")
    with pytest.raises(CatalogueUnreachableError):
        Catalogue(str(tmp_path))


def test_the_default_is_the_environments(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with Catalogue() as catalogue:
        assert catalogue.url.endswith("doormill_ros/catalogue.sqlite")
    monkeypatch.setenv(ENVIRONMENT, str(tmp_path / "mine.sqlite"))
    with Catalogue() as catalogue:
        assert catalogue.url.endswith("mine.sqlite")
