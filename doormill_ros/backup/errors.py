"""What can be wrong with a backup; codes 650..659."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


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
