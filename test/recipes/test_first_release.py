"""The database that the first software of this project wrote is brought up to date with all that is in it."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from doormill_ros.backup.archive import read_archive
from doormill_ros.backup.database import SiteDatabase
from doormill_ros.backup.restore import restore
from doormill_ros.backup.site import make_backup
from doormill_ros.recipes.store import schema
from doormill_ros.recipes.store.database import SHIPPER, RecipeDatabase
from support.source_tree import DATA

DUMP = (DATA / "first_release" / "recipes.sql").read_text(encoding="utf-8")


@pytest.fixture
def old(tmp_path: Path) -> Path:
    path = tmp_path / "site" / "recipes.sqlite"
    path.parent.mkdir()
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript(DUMP)
    return path


def stored(path: Path) -> list[tuple[str, int, str, str, dict]]:
    """Every version as the tables hold it, read without the code under test."""
    with closing(sqlite3.connect(path)) as connection:
        rows = connection.execute(
            "SELECT door_id, version, author, created, document FROM recipe_version ORDER BY door_id, version"
        ).fetchall()
    return [(*row[:4], json.loads(row[4])) for row in rows]


def test_every_version_is_still_there_and_readable(old: Path) -> None:
    before = stored(old)
    assert len(before) == 6
    with RecipeDatabase(str(old)) as database:
        for door_id, version, author, created, document in before:
            recipe = database.get(door_id, version)
            assert (recipe.author, recipe.created.isoformat()) == (author, created)
            for field in ("height_mm", "width_mm", "thickness_mm", "hinge_side", "material"):
                assert recipe.to_document()[field] == document[field]
            assert [f["id"] for f in recipe.to_document()["features"]] == [
                f["id"] for f in document["features"]
            ]
    assert stored(old) == before


def test_it_counts_on_and_still_refuses_to_change_a_version(old: Path) -> None:
    with RecipeDatabase(str(old)) as database:
        recipe = database.find_bar_code("7040000000017")
        assert (recipe.door_id, recipe.version, recipe.author) == ("standard_door", 2, "anna")
        assert database.save(recipe, "bob").version == 3
        # What ships follows the release, but not where somebody saved his own.
        database.add_shipped()
        assert [r.author for r in database.history("standard_door")] == [SHIPPER, "anna", "bob"]
    with closing(sqlite3.connect(old)) as connection, pytest.raises(sqlite3.IntegrityError, match="final"):
        connection.execute("UPDATE recipe_version SET author = 'eve'")


def test_its_backup_is_brought_up_to_date_on_the_way_back(old: Path, tmp_path: Path) -> None:
    before = stored(old)
    make_backup(old.parent, SiteDatabase(str(old)), tmp_path / "old.tar")
    backup = read_archive(tmp_path / "old.tar")
    assert backup.head.revision == schema.REVISIONS[1]
    new = tmp_path / "new"
    new.mkdir()
    restore(backup, new, SiteDatabase(str(new / "recipes.sqlite")))
    assert stored(new / "recipes.sqlite") == before
    with closing(sqlite3.connect(new / "recipes.sqlite")) as connection:
        assert connection.execute("SELECT * FROM alembic_version").fetchall() == [(schema.REVISIONS[-1],)]
