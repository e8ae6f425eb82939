"""A database that somebody else holds is waited for, and not without end."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from doormill_ros.backup import database
from doormill_ros.backup.database import SiteDatabase
from doormill_ros.backup.errors import BackupDatabaseError


@pytest.mark.parametrize("way", ["out", "back"])
def test_a_database_that_somebody_holds_is_told(
    site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, way: str
) -> None:
    monkeypatch.setattr(database, "BUSY", 0.1)
    held, copy = site / "recipes.sqlite", tmp_path / "copy.sqlite"
    one = SiteDatabase(str(held))
    if way == "back":
        one.take(copy)
    with closing(sqlite3.connect(held, isolation_level=None)) as other:
        other.execute("PRAGMA journal_mode = DELETE")
        other.execute("BEGIN EXCLUSIVE")
        with pytest.raises(BackupDatabaseError, match="somebody holds it"):
            one.take(copy) if way == "out" else one.put(copy)
        other.execute("ROLLBACK")
    one.take(tmp_path / "afterwards.sqlite")
