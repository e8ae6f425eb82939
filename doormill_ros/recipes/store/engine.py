"""Connect to the recipe database: SQLite by default, PostgreSQL by URL."""

from __future__ import annotations

import os
import sqlite3
import time
from pathlib import Path

import sqlalchemy as sa
from sqlalchemy.pool import StaticPool

from doormill_ros.recipes.errors import DatabaseUnreachable
from doormill_ros.resources import site_folder
from doormill_ros.units import s_to_ms

ENVIRONMENT, FILE = "DOORMILL_DATABASE", "recipes.sqlite"
BUSY_SECONDS = 30  #: how long a SQLite writer waits for another
_IN_MEMORY = (None, "", ":memory:")
_SWITCH_PAUSE = 0.01  # s
POSTGRESQL_ARGUMENTS = {"connect_timeout": 5}  # s
WRITE = "doormill_write"  #: execution option of a connection that is going to write
READ = "doormill_read"  #: execution option of a connection on which each statement stands alone


def default_url(variable: str = ENVIRONMENT, file: str = FILE) -> str:
    """What an environment variable holds, else a SQLite file of this name in the site's folder."""
    return os.environ.get(variable) or str(site_folder() / file)


def make_engine(url: str | None = None) -> sa.Engine:
    """Engine for a URL; nothing is connected yet.

    Args:
        url: `sqlite:///FILE`, `sqlite://` (in memory), `postgresql://USER:PASSWORD@HOST:PORT/NAME`,
            a file name, or None for `default_url()`.

    Raises:
        DatabaseUnreachable: Not a URL, or of another kind of database.
    """
    parsed, backend = _read(str(url or default_url()))
    if backend == "sqlite":
        return _sqlite(parsed)
    if backend in ("postgresql", "postgres"):
        parsed = parsed.set(drivername="postgresql+psycopg")
        return sa.create_engine(parsed, pool_pre_ping=True, connect_args=POSTGRESQL_ARGUMENTS)
    raise DatabaseUnreachable(
        f"found a database URL of the kind {backend!r}, allowed are sqlite:/// and postgresql://",
        found=backend,
    )


def absolute(url: str) -> str:
    """The same database for who stands in another folder.

    Args:
        url: As for `make_engine`.

    Raises:
        DatabaseUnreachable: Not a URL.
    """
    parsed, backend = _read(url)
    if backend != "sqlite" or parsed.database in _IN_MEMORY:
        return url
    path = str(Path(str(parsed.database)).expanduser().absolute())
    return path if not parsed.query else parsed.set(database=path).render_as_string(hide_password=False)


def check_file(url: str) -> None:
    """Refuse a SQLite file that is not there: to open it would make an empty one.

    Args:
        url: As for `make_engine`; a database in memory or on a server passes.

    Raises:
        DatabaseUnreachable: There is no such file, or it is not a URL.
    """
    parsed, backend = _read(url)
    if backend == "sqlite" and parsed.database not in _IN_MEMORY:
        path = Path(str(parsed.database)).expanduser()
        if not path.exists():
            raise DatabaseUnreachable(f"there is no database {path}; correct its name", path=str(path))


def _read(text: str) -> tuple[sa.URL, str]:
    """The URL that a text or a file's name is, and the kind of its database."""
    if "://" not in text:
        # As text in a URL a name with ? or % would stand for another file.
        return sa.URL.create("sqlite", database=str(Path(text).expanduser())), "sqlite"
    try:
        parsed = sa.make_url(text)
        return parsed, parsed.get_backend_name()
    except (sa.exc.ArgumentError, ValueError) as error:
        raise DatabaseUnreachable(
            f"found the database URL {text!r}, which cannot be read: {error}"
        ) from error


def make_reader(engine: sa.Engine) -> sa.Engine:
    """Engine for statements that stand alone: no transaction is opened round them.

    On PostgreSQL it has connections of its own, which spare the journeys for BEGIN, COMMIT and the
    question whether the server is still there; a broken connection shows when it is used.
    """
    if engine.dialect.name == "postgresql":
        return sa.create_engine(engine.url, isolation_level="AUTOCOMMIT", connect_args=POSTGRESQL_ARGUMENTS)
    return engine.execution_options(**{READ: True})


def _write_ahead(connection: sqlite3.Connection) -> None:
    """Switch a SQLite file to its write-ahead log, which lets readers and a writer in at once.

    For this switch alone SQLite does not wait for others by itself: cells that open a new file at
    the same moment have to try again.
    """
    deadline = time.monotonic() + BUSY_SECONDS
    while True:
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            return
        except sqlite3.OperationalError as error:
            if "locked" not in str(error) or time.monotonic() > deadline:
                raise
            time.sleep(_SWITCH_PAUSE)


def _sqlite(url: sa.URL) -> sa.Engine:
    arguments = {"timeout": BUSY_SECONDS, "check_same_thread": False}
    if url.database in _IN_MEMORY:
        engine = sa.create_engine("sqlite://", connect_args=arguments, poolclass=StaticPool)
    else:
        path = Path(url.database).expanduser()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise DatabaseUnreachable(
                f"the folder {path.parent} of the database cannot be made: {error.strerror}"
            ) from error
        engine = sa.create_engine(url.set(database=str(path)), connect_args=arguments)

    @sa.event.listens_for(engine, "connect")
    def connect(connection: sqlite3.Connection, record: object) -> None:
        # The driver would open transactions by itself and too late; `begin` below does it.
        connection.isolation_level = None
        connection.execute(f"PRAGMA busy_timeout = {s_to_ms(BUSY_SECONDS):.0f}")
        connection.execute("PRAGMA foreign_keys = ON")
        _write_ahead(connection)

    @sa.event.listens_for(engine, "begin")
    def begin(connection: sa.Connection) -> None:
        options = connection.get_execution_options()
        if options.get(READ):
            return
        # A writer takes the lock at once: upgrading a read lock later can end in a deadlock.
        connection.exec_driver_sql("BEGIN IMMEDIATE" if options.get(WRITE) else "BEGIN")

    return engine
