"""What can be wrong with a backup; codes 650..659."""

from __future__ import annotations

import errno

from doormill_ros.errors import DoormillError

_ADVICE = {
    errno.ENOSPC: "free the disk",
    errno.EDQUOT: "free the disk",
    errno.EFBIG: "raise the limit on the size of files (ulimit -f)",
    errno.ENAMETOOLONG: "no backup of a site has such names",
    errno.ENOTDIR: "no backup of a site has such names",
    errno.EISDIR: "no backup of a site has such names",
    errno.EEXIST: "no backup of a site has such names",
    errno.EACCES: "let it be written by this user",
    errno.EPERM: "let it be written by this user",
    errno.EROFS: "let it be written by this user",
}


def advice_on(error: OSError) -> str:
    """What helps where the disk refuses to write something."""
    return _ADVICE.get(error.errno or 0, "look at the disk")


class BackupError(DoormillError):
    """Base of what keeps a backup from being made or restored."""


BackupFileError = BackupError.row(
    "BackupFileError", 650, "A backup cannot be written, or what belongs into it cannot be read."
)
TornBackupError = BackupError.row("TornBackupError", 651, "A backup is cut short, damaged or none at all.")
NewerBackupError = BackupError.row("NewerBackupError", 652, "A later release has written the backup.")
BackupEntryError = BackupError.row(
    "BackupEntryError", 653, "A backup holds something that does not belong into a site."
)
BackupDatabaseError = BackupError.row(
    "BackupDatabaseError",
    654,
    "The database cannot be put into a backup, or that of a backup not into place.",
)
RestoreError = BackupError.row("RestoreError", 655, "A restore failed, and what it had done was taken back.")
RestoreBusyError = BackupError.row(
    "RestoreBusyError", 656, "Another backup or restore works on the same site."
)
