"""The recipe database in a backup: SQLite by its online copy, PostgreSQL by pg_dump and pg_restore."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import sqlite3
import subprocess
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

import sqlalchemy as sa

from doormill_ros.backup.errors import BackupDatabaseError, NewerBackupError, advice_on
from doormill_ros.errors import DoormillError
from doormill_ros.recipes.store import schema
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.recipes.store.engine import make_engine

SQLITE, POSTGRESQL = "sqlite", "postgresql"
NAMES = {SQLITE: "recipes.sqlite", POSTGRESQL: "recipes.pgdump"}  #: in the backup's folder `database`
LIMIT = 3600.0  # s, for pg_dump and pg_restore
BUSY = 30.0  # s; how long a cell that writes is waited for
OWN = (
    "alembic_version",
    *schema.metadata.tables,
)  #: tables of the recipes; the database may hold others beside them
ENDINGS = ("", "-wal", "-shm")  #: of the files of one SQLite database


class SiteDatabase:
    """The database of a site, running cells or not.

    Args:
        url: See `make_engine`.

    Attributes:
        kind: "sqlite" or "postgresql".
        name: What its content is called in a backup.

    Raises:
        DatabaseUnreachable: Not a URL, or of another kind of database.
        BackupDatabaseError: It is in memory only.
    """

    def __init__(self, url: str | None = None) -> None:
        engine = make_engine(url)
        self.url = engine.url
        engine.dispose()
        self.kind = SQLITE if self.url.get_backend_name() == SQLITE else POSTGRESQL
        self.name = NAMES[self.kind]
        if self.kind == SQLITE and self.url.database in (None, "", ":memory:"):
            raise BackupDatabaseError("a database in memory cannot be backed up; name a file or a server")

    @property
    def present(self) -> bool:
        """There is something to back up; a server is taken to have its database."""
        return self.kind == POSTGRESQL or self._file.is_file()

    def take(self, copy: Path) -> str:
        """Copy the content as of one moment into a file that is not there yet; returns the schema's revision.

        Raises:
            DatabaseUnreachable: It does not answer.
            BackupDatabaseError: It cannot be copied.
        """
        if self.kind == SQLITE:
            with _failures("copied"), _connected(self._file) as source, _connected(copy) as target:
                _copy(source, target)
                target.execute("PRAGMA journal_mode = DELETE")
                shutil.copymode(self._file, copy)
            return _revision(copy)
        others = _others(self._tables())
        # With their sequences, which a dump would hold all the same.
        without = [f'--exclude-table="{name}"{rest}' for name in others for rest in ("", "_*_seq")]
        self._run(
            "pg_dump", self._dbname, "--format=custom", "--no-owner", "--no-acl", *without, f"--file={copy}"
        )
        with contextlib.closing(RecipeDatabase(self.url.render_as_string(hide_password=False))):
            return schema.REVISIONS[-1]  # an older one was migrated by being opened

    def keep(self, copy: Path) -> None:
        """As `take`, but a SQLite file that is damaged is copied as it is: it is to be replaced.

        Raises:
            DatabaseUnreachable: A server does not answer.
            BackupDatabaseError: It cannot be copied.
        """
        try:
            self.take(copy)
        except BackupDatabaseError:
            if self.kind != SQLITE:
                raise
            with _failures("copied"):
                _copy_files(self._file, copy)

    def judge(self, copy: Path, kind: str, revision: str) -> None:
        """Refuse a copy that cannot be put into place; one of an earlier release is brought up to this one.

        Raises:
            BackupDatabaseError: It is damaged, of another kind of database, or to take the place of a SQLite file that
                holds other tables too.
            NewerBackupError: A later release has written it.
        """
        if kind != self.kind:
            raise BackupDatabaseError(
                f"the backup holds a database of the kind {kind!r}, the one in use is {self.kind!r}; restore with "
                "--database of that kind, and use `recipes export` and `recipes import` to change over",
                found=kind,
            )
        if kind == SQLITE:
            if others := _others(_tables_of(self._file) if self.present else ()):
                raise BackupDatabaseError(
                    f"the database {self._file} holds the tables {', '.join(others)} beside the recipes, and restoring "
                    "would set them back too; give the catalogue a file of its own (catalogue --database FILE rebuild "
                    "DIR) and drop its tables here"
                )
            with _failures("read"), _connected(copy) as connection:
                said = connection.execute("PRAGMA integrity_check").fetchone()[0]
            if said != "ok":
                raise BackupDatabaseError(
                    f"the database in the backup is damaged: {said}; take another backup"
                )
            revision = _revision(copy)
        if revision not in schema.REVISIONS:
            raise NewerBackupError(
                f"the backup's database has schema {revision!r}, allowed is up to {schema.REVISIONS[-1]!r}; update "
                "this installation",
                found=revision,
            )
        if kind == SQLITE:
            try:
                RecipeDatabase(str(copy)).close()
            except DoormillError as error:
                raise BackupDatabaseError(f"the database in the backup cannot be used: {error}") from error
            with _failures("read"), _connected(copy) as connection:
                connection.execute("PRAGMA journal_mode = DELETE")

    def put(self, copy: Path) -> None:
        """Replace the content by that of a copy, in one transaction; cells that have it open go on with the new one.

        What else a server's database holds stays, whether it is in the copy or not.

        A SQLite file that is damaged has no content to replace: the file itself gives way.

        Raises:
            BackupDatabaseError: It cannot be replaced; the old content stays.
        """
        if self.kind == SQLITE:
            with _failures("replaced"):
                self._file.parent.mkdir(parents=True, exist_ok=True)
                if not self.present:
                    self._file.touch(0o600)
                    shutil.copymode(copy, self._file)
                try:
                    with _connected(copy) as source, _connected(self._file) as target:
                        _copy(source, target)
                except sqlite3.OperationalError:  # somebody holds it, or it may not be written
                    raise
                except sqlite3.DatabaseError:
                    self.remove()
                    _copy_files(copy, self._file)
            return
        with tempfile.TemporaryDirectory(prefix="doormill-") as folder:
            script, chosen = Path(folder) / "restore.sql", Path(folder) / "chosen"
            chosen.write_text(_own_entries(self._run("pg_restore", "--list", str(copy))), encoding="utf-8")
            own = ("--clean", "--if-exists", "--no-owner", f"--use-list={chosen}")
            self._run("pg_restore", *own, f"--file={script}", str(copy))
            # A dump of an earlier release drops no table that came since, which would stand in the migration's way.
            drop = f"DROP TABLE IF EXISTS {', '.join(OWN)}"
            whole = ("--no-psqlrc", "--quiet", "--set=ON_ERROR_STOP=1", "--single-transaction")
            self._run("psql", *whole, self._dbname, f"--command={drop}", f"--file={script}")
        RecipeDatabase(self.url.render_as_string(hide_password=False)).close()

    def remove(self) -> None:
        """Take away a database that was not there before; a server's stays."""
        if self.kind == SQLITE:
            for ending in ENDINGS:
                Path(f"{self._file}{ending}").unlink(missing_ok=True)

    @property
    def _file(self) -> Path:
        return Path(str(self.url.database))

    @property
    def _dbname(self) -> str:
        """The option that names the database to a program of PostgreSQL, without the password."""
        bare = sa.URL.create("postgresql", self.url.username, None, self.url.host, self.url.port)
        return f"--dbname={bare.set(database=self.url.database, query=self.url.query).render_as_string()}"

    def _tables(self) -> list[str]:
        engine = make_engine(self.url.render_as_string(hide_password=False))
        try:
            with engine.connect() as connection:
                return sa.inspect(connection).get_table_names()
        except sa.exc.DBAPIError as error:
            raise BackupDatabaseError(
                f"the database does not answer: {' '.join(str(error.orig).split())}"
            ) from error
        finally:
            engine.dispose()

    def _run(self, program: str, *arguments: str) -> str:
        """Run a program of PostgreSQL; the password goes by the environment, which only we can read.

        Returns:
            What it printed.
        """
        environment = {**os.environ, "PGCONNECT_TIMEOUT": "5"}
        if self.url.password is not None:
            environment["PGPASSWORD"] = str(self.url.password)
        command = [program, *arguments]
        try:
            done = subprocess.run(
                command, env=environment, capture_output=True, text=True, errors="replace", timeout=LIMIT
            )
        except FileNotFoundError as error:
            raise BackupDatabaseError(
                f"{program} is not installed; install PostgreSQL's client (apt-get install postgresql-client)"
            ) from error
        except subprocess.TimeoutExpired as error:
            raise BackupDatabaseError(
                f"{program} did not end within {LIMIT:.0f} s; see the server"
            ) from error
        if done.returncode != 0:
            raise BackupDatabaseError(f"{program} failed: {' '.join(done.stderr.split())}")
        return done.stdout


def _others(tables: Iterable[str]) -> list[str]:
    """Those that are not the recipes'."""
    return sorted(set(tables) - set(OWN))


def _own_entries(listed: str) -> str:
    """The lines of a dump's list without what is of other tables: former releases put those into it too."""
    tables = [match[1] for match in re.finditer(r" TABLE \S+ (\S+) ", listed)]
    theirs = tuple(_others(tables))
    begins = tuple(f"{name}_" for name in theirs)  # of their indexes and sequences

    def own(line: str) -> bool:
        words = set(line.split())
        return bool(words & set(OWN)) or not any(word in theirs or word.startswith(begins) for word in words)

    return "\n".join(line for line in listed.splitlines() if own(line)) + "\n"


def _tables_of(path: Path) -> list[str]:
    """Tables of a SQLite file; none where it is damaged, for then it is to be replaced."""
    try:
        with _connected(path) as connection:
            found = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall()
    except sqlite3.DatabaseError:
        return []
    return [str(name) for (name,) in found if not str(name).startswith("sqlite_")]


def _copy(source: sqlite3.Connection, target: sqlite3.Connection) -> None:
    def look(status: int, remaining: int, pages: int) -> None:
        # Each of the connections has waited for `BUSY`; left alone, the copy asks again without end.
        if status == sqlite3.SQLITE_BUSY:
            raise sqlite3.OperationalError(f"somebody holds it for longer than {BUSY:g} s")

    source.backup(target, progress=look)


def _copy_files(source: Path, target: Path) -> None:
    for ending in ENDINGS:
        if Path(f"{source}{ending}").is_file():
            shutil.copy(f"{source}{ending}", f"{target}{ending}")


@contextlib.contextmanager
def _connected(path: Path) -> Iterator[sqlite3.Connection]:
    with contextlib.closing(sqlite3.connect(path, timeout=BUSY, isolation_level=None)) as connection:
        yield connection


@contextlib.contextmanager
def _failures(what: str) -> Iterator[None]:
    try:
        yield
    except sqlite3.Error as error:
        raise BackupDatabaseError(f"the database cannot be {what}: {error}; {_advice(error)}") from error
    except OSError as error:
        raise BackupDatabaseError(f"the database cannot be {what}: {error}; {advice_on(error)}") from error


def _advice(error: sqlite3.Error) -> str:
    name = getattr(error, "sqlite_errorname", "")
    if name.startswith(("SQLITE_IOERR", "SQLITE_FULL")):
        return "look at the disk, and at the limit on the size of files (ulimit -f)"
    return "stop the cells that use it, or take another backup"


def _revision(copy: Path) -> str:
    engine = sa.create_engine(sa.URL.create("sqlite", database=str(copy)))
    try:
        with engine.connect() as connection:
            return schema.current_revision(connection) or ""
    except sa.exc.DatabaseError as error:
        raise BackupDatabaseError(
            f"the database cannot be read: {error.orig}; take another backup"
        ) from error
    finally:
        engine.dispose()
