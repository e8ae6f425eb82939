"""The database that the first software of this project wrote is brought up to date with all that is in it."""

from __future__ import annotations

import json
import os
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import psycopg
import pytest
import sqlalchemy as sa

from doormill_ros.backup.archive import read_archive
from doormill_ros.backup.database import SiteDatabase
from doormill_ros.backup.restore import restore
from doormill_ros.backup.site import make_backup
from doormill_ros.recipes.store import schema
from doormill_ros.recipes.store.database import SHIPPER, RecipeDatabase
from support.postgres import Server, find_binaries
from support.source_tree import DATA

FIRST = DATA / "first_release"
DUMP = (FIRST / "recipes.sql").read_text(encoding="utf-8")
POSTGRESQL = (FIRST / "postgresql.sql").read_text(encoding="utf-8")
#: The rows are the same text on both; `postgresql.sql` has tables, constraints and triggers.
ROWS = [line for line in DUMP.splitlines() if line.startswith("INSERT INTO")]


def in_sqlite(path: Path) -> str:
    path.parent.mkdir()
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript(DUMP)
    return f"sqlite:///{path}"


def in_postgresql(server: Server) -> str:
    url = server.empty_database()
    with psycopg.connect(url) as connection:
        for text in (POSTGRESQL, *ROWS):
            connection.execute(text)
    return url


@pytest.fixture(params=["sqlite", "postgresql"])
def old(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """URL of the database as the first release left it, in a site's folder or on a server."""
    if request.param == "sqlite":
        return in_sqlite(tmp_path / "site" / "recipes.sqlite")
    return in_postgresql(request.getfixturevalue("postgres"))


@pytest.fixture
def programs(monkeypatch: pytest.MonkeyPatch) -> None:
    """The server's own pg_dump, which is as new as it."""
    monkeypatch.setenv("PATH", f"{find_binaries()}{os.pathsep}{os.environ['PATH']}")


def rows_of(url: str, question: str) -> list[tuple[Any, ...]]:
    """What the tables hold, read without the code under test."""
    engine = sa.create_engine(url.replace("postgresql://", "postgresql+psycopg://"))
    try:
        with engine.connect() as connection:
            return [tuple(row) for row in connection.execute(sa.text(question))]
    finally:
        engine.dispose()


def stored(url: str) -> list[tuple[str, int, str, str, dict[str, Any]]]:
    """Every version."""
    found = rows_of(url, "SELECT door_id, version, author, created, document FROM recipe_version")
    return sorted((*row[:4], json.loads(row[4])) for row in found)


def revision(url: str) -> str:
    ((found,),) = rows_of(url, "SELECT version_num FROM alembic_version")
    return str(found)


def test_every_version_is_still_there_and_readable(old: str) -> None:
    before = stored(old)
    assert (len(before), revision(old)) == (6, schema.REVISIONS[1])
    with RecipeDatabase(old) as database:
        for door_id, version, author, created, document in before:
            recipe = database.get(door_id, version)
            assert (recipe.author, recipe.created.isoformat()) == (author, created)
            for field in ("height_mm", "width_mm", "thickness_mm", "hinge_side", "material"):
                assert recipe.to_document()[field] == document[field]
            assert [f["id"] for f in recipe.to_document()["features"]] == [
                f["id"] for f in document["features"]
            ]
    assert (stored(old), revision(old)) == (before, schema.REVISIONS[-1])


def test_it_counts_on_and_still_refuses_to_change_a_version(old: str) -> None:
    with RecipeDatabase(old) as database:
        recipe = database.find_bar_code("7040000000017")
        assert (recipe.door_id, recipe.version, recipe.author) == ("standard_door", 2, "anna")
        assert database.save(recipe, "bob").version == 3
        # What ships follows the release, but not where somebody saved his own.
        database.add_shipped()
        assert [r.author for r in database.history("standard_door")] == [SHIPPER, "anna", "bob"]
    with pytest.raises(sa.exc.DBAPIError, match="final"):
        rows_of(old, "UPDATE recipe_version SET author = 'eve'")


def test_its_backup_is_brought_up_to_date_on_the_way_back(tmp_path: Path) -> None:
    old = in_sqlite(tmp_path / "site" / "recipes.sqlite")
    before = stored(old)
    make_backup(tmp_path / "site", SiteDatabase(old), tmp_path / "old.tar")
    backup = read_archive(tmp_path / "old.tar")
    assert backup.head.revision == schema.REVISIONS[1]
    new = tmp_path / "new"
    new.mkdir()
    url = f"sqlite:///{new / 'recipes.sqlite'}"
    restore(backup, new, SiteDatabase(url))
    assert (stored(url), revision(url)) == (before, schema.REVISIONS[-1])


def test_a_server_s_backup_of_then_takes_the_place_of_what_this_release_made_of_it(
    postgres: Server, programs: None, tmp_path: Path
) -> None:
    """The dump was taken before the update; tables that came since stand in its way."""
    url = in_postgresql(postgres)
    before = stored(url)
    make_backup(tmp_path, SiteDatabase(url), tmp_path / "old.tar")
    with RecipeDatabase(url) as database:
        database.save(database.get("standard_door"), "bob")
        database.add_shipped()
        restore(read_archive(tmp_path / "old.tar"), tmp_path, SiteDatabase(url))
        assert database.save(database.get("standard_door"), "bob").version == 3
    assert revision(url) == schema.REVISIONS[-1]
    assert [row for row in stored(url) if row[2] != "bob"] == before
