"""What a site has of its own, made into a backup."""

from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

from doormill_ros import __version__
from doormill_ros.backup.archive import (
    DATABASE,
    PARTS,
    Backup,
    BackupHead,
    read_archive,
    sweep_parts,
    write_archive,
)
from doormill_ros.backup.database import SiteDatabase
from doormill_ros.backup.errors import BackupFileError, RestoreBusyError
from doormill_ros.models.store import ModelStore
from doormill_ros.resources import AUDIT, MODELS

LOCK = ".backup.lock"
_COPIES = ".backup-"  # begin of the name of a folder of copies
_WRITTEN = (MODELS, AUDIT)  # parts that nodes write to meanwhile


@contextmanager
def alone(site: Path) -> Iterator[None]:
    """Let one backup or restore at a time work on a site.

    Raises:
        RestoreBusyError: Another one does.
        BackupFileError: The folder cannot be made or written.
    """
    try:
        site.mkdir(parents=True, exist_ok=True)
        stream = (site / LOCK).open("w")
    except OSError as error:
        raise BackupFileError(f"the site's folder {site} cannot be written: {error}") from error
    with stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise RestoreBusyError(f"another backup or restore works on {site}; wait for its end") from error
        yield


def make_backup(site: Path, database: SiteDatabase, path: Path) -> Backup:
    """Put database, configuration, models, accepted bags and audit log of a site into one file.

    Args:
        site: The site's folder; see `alone`.
        database: Of the recipes; left out where there is none yet.
        path: The file to write; must not exist.

    Returns:
        The backup as it was read back.

    Raises:
        BackupError: Something cannot be read or written; there is no file then.
        DatabaseUnreachable: The database does not answer.
    """
    made = datetime.now(UTC).isoformat(timespec="seconds")
    sweep_parts(path)
    for left in site.glob(f"{_COPIES}*"):
        shutil.rmtree(left, ignore_errors=True)  # of a backup that was killed: nobody else works on this site
    with tempfile.TemporaryDirectory(prefix=_COPIES, dir=site) as folder:
        entries = [entry for part in PARTS if part not in _WRITTEN for entry in _files(site / part, part, ())]
        with ModelStore(site / MODELS).held():
            entries += [entry for part in _WRITTEN for entry in _copied(site / part, part, Path(folder))]
        head = BackupHead(__version__, made)
        if database.present:
            copy = Path(folder) / database.name
            revision = database.take(copy)
            head = BackupHead(__version__, made, database.kind, revision)
            entries.insert(0, (f"{DATABASE}/{database.name}", copy))
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise BackupFileError(f"the folder {path.parent} cannot be made: {error.strerror}") from error
        write_archive(path, head, entries)
    return read_archive(path)


def _copied(path: Path, name: str, folder: Path) -> list[tuple[str, Path]]:
    """As `_files`, of copies in a folder: what is added from now on belongs to the next backup."""
    copies = []
    for entry, source in _files(path, name, ()):
        copy = folder / entry
        try:
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, copy)
        except OSError as error:
            raise BackupFileError(
                f"{source} cannot be copied to {copy}: {error.strerror}; try again"
            ) from error
        copies.append((entry, copy))
    return copies


def _files(path: Path, name: str, above: tuple[Path, ...]) -> Iterator[tuple[str, Path]]:
    """Files below a folder with their names in the backup; links are followed, for they may lead out of the site."""
    if path.is_file():
        yield name, path
    elif path.is_dir():
        real = path.resolve()
        if real in above:
            raise BackupFileError(f"{path} leads back to a folder above it; remove the link")
        try:
            below = sorted(os.listdir(path))
        except OSError as error:
            raise BackupFileError(f"{path} cannot be read: {error.strerror}") from error
        for entry in below:
            yield from _files(path / entry, f"{name}/{entry}", (*above, real))
    elif path.is_symlink() or path.exists():
        raise BackupFileError(f"{path} is no file and no folder, or leads nowhere; remove it")
