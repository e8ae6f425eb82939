"""Put a backup into place; what was there is moved aside, and a restore that was cut off is taken back."""

from __future__ import annotations

import json
import os
import shutil
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from doormill_ros.backup.archive import DATABASE, PARTS, Backup
from doormill_ros.backup.database import SiteDatabase
from doormill_ros.backup.errors import RestoreError, advice_on
from doormill_ros.errors import DoormillError
from doormill_ros.files import write_atomically

WORK = ".restore"  #: folder in the site, there only while a restore is under way
NEW, OLD, BEGUN = (
    "new",
    "old",
    "begun.json",
)  #: in it: what comes, what was there, and that it is being exchanged
REPLACED = "replaced"  #: folder in the site that keeps what a restore replaced


def restore(backup: Backup, site: Path, database: SiteDatabase) -> Path:
    """Replace what a site has by what a backup holds.

    Args:
        backup: Read to its end.
        site: The site's folder; see `alone`. Parts that the backup lacks are moved aside too.
        database: Whose content is replaced, where the backup holds one.

    Returns:
        The folder with what was there before.

    Raises:
        BackupError: It does not fit, or could not be put into place; the site is as it was.
    """
    take_back(site, database)
    work = site / WORK
    try:
        (work / OLD).mkdir(parents=True)
        (work / NEW).mkdir()
        backup.extract(work / NEW)
        copy = work / NEW / DATABASE / database.name
        if backup.head.database:
            database.judge(copy, backup.head.database, backup.head.revision)
            if database.present:
                (work / OLD / DATABASE).mkdir()
                database.keep(work / OLD / DATABASE / database.name)
        _exchange(work, site, database, copy if backup.head.database else None)
        return _settle(work, site)
    except Exception as error:
        try:
            take_back(site, database)
        except (OSError, DoormillError) as second:
            raise RestoreError(
                f"the restore failed ({error}), and so did taking it back ({second}); what was there is in "
                f"{work / OLD}, run `restore` again"
            ) from error
        if isinstance(error, OSError):
            raise RestoreError(
                f"the restore failed and was taken back: {error}; {advice_on(error)}"
            ) from error
        raise


def take_back(site: Path, database: SiteDatabase) -> bool:
    """Undo a restore that was cut off, however far it had come; False where there is none.

    Raises:
        BackupDatabaseError: The database cannot be replaced.
        OSError: A folder cannot be moved.
    """
    work = site / WORK
    if not work.is_dir():
        return False
    if (work / BEGUN).is_file():
        begun = json.loads((work / BEGUN).read_text(encoding="utf-8"))
        _undo(work, site, database, begun)
        # From here on nothing of it is in the site.
        (work / BEGUN).unlink()
    shutil.rmtree(work)
    return True


def _exchange(work: Path, site: Path, database: SiteDatabase, copy: Path | None) -> None:
    """Move the old away and the new in; `BEGUN` says beforehand what there is to move."""
    old_copy = work / OLD / DATABASE / database.name
    new = [part for part in PARTS if (work / NEW / part).exists()]
    begun = {
        "new": new,
        "database": copy is not None,
        "old_database": old_copy.is_file(),
    }
    write_atomically(work / BEGUN, json.dumps(begun), durable=True)
    for part in PARTS:
        if os.path.lexists(site / part):
            os.replace(site / part, work / OLD / part)
        if part in new:
            os.replace(work / NEW / part, site / part)
    if copy is not None:
        database.put(copy)


def _undo(work: Path, site: Path, database: SiteDatabase, begun: dict[str, Any]) -> None:
    if begun["old_database"]:
        database.put(work / OLD / DATABASE / database.name)
    elif begun["database"]:
        database.remove()
    for part in PARTS:
        if part in begun["new"] and not (work / NEW / part).exists() and (site / part).exists():
            os.replace(site / part, work / NEW / part)
        if os.path.lexists(work / OLD / part):
            os.replace(work / OLD / part, site / part)


def _settle(work: Path, site: Path) -> Path:
    """Keep what was there; from the rename on the restore counts as done."""
    kept = site / REPLACED / datetime.now(UTC).strftime("%Y%m%dT%H%M%S%fZ")
    kept.parent.mkdir(exist_ok=True)
    os.replace(work, kept)
    (kept / BEGUN).unlink()
    shutil.rmtree(kept / NEW)
    for path in (kept / OLD).iterdir():
        os.replace(path, kept / path.name)
    (kept / OLD).rmdir()
    return kept
