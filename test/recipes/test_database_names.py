"""Names of database files that mean something in a URL."""

from __future__ import annotations

from pathlib import Path

import pytest

from doormill_ros.backup.database import SiteDatabase
from doormill_ros.backup.restore import restore
from doormill_ros.backup.site import make_backup
from doormill_ros.catalogue.database import Catalogue
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.recipes.store.engine import check_file

NAMES = ["what?", "50%", "a#b", "a%3Fb", "q?mode=memory"]


@pytest.mark.parametrize("name", NAMES)
def test_a_database_lies_where_it_is_named(tmp_path: Path, name: str) -> None:
    file = tmp_path / name / f"{name}.sqlite"
    RecipeDatabase(str(file)).close()
    assert file.is_file()
    check_file(str(file))
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("name", NAMES)
def test_the_default_lies_in_the_site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv("DOORMILL_SITE", str(tmp_path / name))
    Catalogue().close()
    RecipeDatabase().close()
    assert {path.name for path in (tmp_path / name).glob("*.sqlite")} == {
        "catalogue.sqlite",
        "recipes.sqlite",
    }
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("name", NAMES)
def test_a_site_of_such_a_name_is_backed_up_and_restored(tmp_path: Path, name: str) -> None:
    site = tmp_path / name
    database = SiteDatabase(str(site / "recipes.sqlite"))
    with RecipeDatabase(str(site / "recipes.sqlite")) as recipes:
        recipes.add_shipped()
        count = len(recipes.list())
    backup = make_backup(site, database, tmp_path / "b.tar")
    assert backup.head.revision
    (site / "recipes.sqlite").unlink()
    restore(backup, site, database)
    with RecipeDatabase(str(site / "recipes.sqlite")) as recipes:
        assert len(recipes.list()) == count
