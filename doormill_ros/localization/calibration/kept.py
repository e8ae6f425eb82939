"""Old calibrations: each file that is written over is kept, and can be put back.

Those of `camera.yaml` stand in the folder `camera.yaml.kept` beside it as 001.yaml, 002.yaml and so on, newest last.
"""

from __future__ import annotations

import errno
from pathlib import Path

from doormill_ros.files import write_atomically
from doormill_ros.localization.calibration.errors import NothingKept
from doormill_ros.localization.camera import load_camera


def kept(path: Path, suffix: str = ".yaml") -> list[Path]:
    """What is kept of a file under names with that suffix, the oldest first.

    Raises:
        OSError: The path is no name of a file.
    """
    found = [p for p in _folder(path).glob(f"*{suffix}") if p.stem.isdecimal()]
    return sorted(found, key=lambda p: int(p.stem))


def keep(path: Path, suffix: str = ".yaml") -> Path | None:
    """Keep what a file holds now; None when there is nothing, or when the newest kept one holds the same.

    Args:
        path: The file.
        suffix: Of the name under which it is kept.

    Raises:
        OSError: It cannot be kept.
    """
    if not path.exists():
        return None
    content, before = path.read_bytes(), kept(path, suffix)
    if before and before[-1].read_bytes() == content:
        return None
    number = int(before[-1].stem) + 1 if before else 1
    _folder(path).mkdir(exist_ok=True)
    copy = _folder(path) / f"{number:03d}{suffix}"
    write_atomically(copy, content, durable=True)
    return copy


def restore(path: Path, number: int | None = None) -> Path:
    """Put a kept camera file back, the newest that differs when no number is given; what is displaced is kept in turn.

    Raises:
        NothingKept: There is no such file.
        BadCameraFile: It holds no camera, or names a picture that is gone.
        OSError: It cannot be written.
    """
    present = path.read_bytes() if path.exists() else None
    all_kept = kept(path)
    fitting = [
        p for p in all_kept if (p.read_bytes() != present if number is None else int(p.stem) == number)
    ]
    if not fitting:
        names = ", ".join(str(int(p.stem)) for p in all_kept) or "none"
        wanted = "one that differs from the present" if number is None else f"number {number}"
        raise NothingKept(f"of {path} {names} are kept, {wanted} is asked for; give one of these numbers")
    source = fitting[-1]
    load_camera(source, path.parent)
    content = source.read_bytes()
    keep(path)
    write_atomically(path, content, durable=True)
    return source


def _folder(path: Path) -> Path:
    if not path.name:
        raise IsADirectoryError(errno.EISDIR, "a folder, allowed is the name of a file", str(path))
    return path.with_name(f"{path.name}.kept")
