"""Replace a file in one step, so that a reader finds the old content or the new one and nothing between."""

from __future__ import annotations

import contextlib
import os
import secrets
from pathlib import Path

from doormill_ros.abb.errors import TargetFileWriteError


def write_atomically(path: Path, data: bytes) -> None:
    """Write a file beside `path`, read it back, and rename it over `path`.

    On any failure `path` keeps what it held and the file beside it is removed.

    Args:
        path: File to replace or create; its folder exists.
        data: The whole new content.

    Raises:
        TargetFileWriteError: The content could not be written, reads back differently, or the
            rename failed.
    """
    path = Path(path)
    # A hidden name that no reader asks for; random, so that two writers never share one.
    beside = path.with_name(f".{path.name}.{secrets.token_hex(6)}.part")
    try:
        with open(beside, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        _compare(beside, data)
        os.replace(beside, path)
        _sync_folder(path.parent)
        _compare(path, data)
    except OSError as error:
        raise TargetFileWriteError(
            f"{path} could not be written ({error.strerror or error}); allowed is a writable folder with "
            f"{len(data)} free bytes: check the folder, its rights and the disk",
            path=str(path),
            size=len(data),
        ) from error
    finally:
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)


def _compare(path: Path, data: bytes) -> None:
    """Raise unless the file holds exactly `data`."""
    found = path.read_bytes()
    if found != data:
        same = next((i for i, (a, b) in enumerate(zip(found, data, strict=False)) if a != b), None)
        where = len(found) if same is None else same
        raise TargetFileWriteError(
            f"{path} reads back with {len(found)} bytes and first differs at byte {where}, written were "
            f"{len(data)} bytes: check that nothing else writes there, and the disk",
            path=str(path),
            size=len(data),
            found=len(found),
        )


def _sync_folder(folder: Path) -> None:
    """Make the rename survive a power cut where the system can do that."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
