"""A database that holds the catalogue of runs beside the recipes: a restore sets back the recipes alone."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from doormill_ros.backup import database as room
from doormill_ros.catalogue.database import Catalogue
from doormill_ros.catalogue.run import CataloguedRun
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.tools import backup as backup_tool
from doormill_ros.tools import restore as restore_tool
from support.postgres import Server


def kept(url: str) -> dict[str, str]:
    with Catalogue(url) as catalogue:
        return {row.run.run_id: row.kept for row in catalogue.rows()}


def note(url: str, run_id: str) -> None:
    with Catalogue(url) as catalogue:
        catalogue.store("", [CataloguedRun(run_id)])
        catalogue.keep([run_id], "customer asks")


@pytest.mark.parametrize("former", [False, True])
def test_on_postgresql_the_catalogue_stays_as_it_is(
    server: Server, site: Path, recipe: Recipe, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, former: bool
) -> None:
    """Backups of former releases hold everything that was in the database."""
    url = server.empty_database()
    with RecipeDatabase(url) as database:
        database.save(recipe, "anna")
    note(url, "run_0")
    arguments = ["--site", str(site), "--database", url]
    with monkeypatch.context() as patch:
        if former:
            patch.setattr(room, "_others", lambda found: [], raising=False)
        assert backup_tool.main([str(tmp_path / "b.tar"), *arguments]) == 0
    note(url, "run_1")
    with RecipeDatabase(url) as database:
        database.save(recipe, "bob")
    assert restore_tool.main([str(tmp_path / "b.tar"), *arguments]) == 0
    with RecipeDatabase(url) as database:
        assert database.get(recipe.door_id).version == 1
    assert kept(url) == {"run_0": "customer asks", "run_1": "customer asks"}
    (replaced,) = (site / "replaced").iterdir()
    listed = subprocess.run(
        ["pg_restore", "--list", replaced / "database" / "recipes.pgdump"], capture_output=True, text=True
    )
    assert "recipe_version" in listed.stdout
    assert "catalogue" not in listed.stdout


def test_into_an_empty_postgresql_the_recipes_alone_come(
    server: Server, site: Path, recipe: Recipe, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    url = server.empty_database()
    with RecipeDatabase(url) as database:
        database.save(recipe, "anna")
    note(url, "run_0")
    with monkeypatch.context() as patch:
        patch.setattr(room, "_others", lambda found: [], raising=False)
        assert backup_tool.main([str(tmp_path / "b.tar"), "--site", str(site), "--database", url]) == 0
    other = server.empty_database()
    arguments = ["--site", str(tmp_path / "other"), "--database", other]
    assert restore_tool.main([str(tmp_path / "b.tar"), *arguments]) == 0
    with RecipeDatabase(other) as database:
        assert database.get(recipe.door_id).version == 1
    assert kept(other) == {}


def test_on_sqlite_a_shared_file_is_refused(
    site: Path, recipe: Recipe, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    url = str(site / "recipes.sqlite")
    assert backup_tool.main([str(tmp_path / "b.tar"), "--site", str(site)]) == 0
    note(url, "run_0")
    assert restore_tool.main([str(tmp_path / "b.tar"), "--site", str(site)]) == 2
    said = capsys.readouterr().err
    assert "holds the tables catalogue_inspection, catalogue_kept" in said
    assert kept(url) == {"run_0": "customer asks"}
    assert not (site / "replaced").exists()
