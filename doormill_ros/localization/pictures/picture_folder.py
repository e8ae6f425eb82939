"""Pictures that somebody puts into a folder, each given out once."""

from __future__ import annotations

import re
from pathlib import Path

from doormill_ros.localization.errors import BadPicture

SUFFIXES = (".png", ".jpg", ".jpeg")
LARGEST = 256 << 20  # bytes of a file


class PictureFolder:
    """A folder that may fill while it is looked at; a file belongs there whole, so rename it into the folder."""

    def __init__(self, path: Path) -> None:
        """Look into `path`, which may come to be later."""
        self.path = path
        self._given: set[str] = set()

    def take(self) -> Path | None:
        """The first file by name that was not given out yet, numbers in names by their value; None without one."""
        waiting = self._waiting()
        if not waiting:
            return None
        self._given.add(waiting[0].name)
        return waiting[0]

    @property
    def left(self) -> int:
        """Files that wait."""
        return len(self._waiting())

    def read(self, path: Path) -> bytes:
        """Content of a file.

        Raises:
            BadPicture: It is gone or larger than a picture is.
        """
        try:
            size = path.stat().st_size
            content = path.read_bytes() if size <= LARGEST else b""
        except OSError as error:
            raise BadPicture(
                f"cannot be read ({error.strerror}); put it there again", path=str(path)
            ) from error
        if size > LARGEST:
            raise BadPicture(
                f"has {size} bytes, allowed are {LARGEST}; save it smaller", path=str(path), size=size
            )
        return content

    def _waiting(self) -> list[Path]:
        try:
            files = [
                f
                for f in self.path.iterdir()
                if f.suffix.lower() in SUFFIXES and f.name[0] != "." and f.is_file()
            ]
        except OSError:
            return []
        return sorted((f for f in files if f.name not in self._given), key=_by_number)


def _by_number(path: Path) -> list[tuple[int, str]]:
    parts = re.split(r"(\d+)", path.name)
    return [(int(part), "") if part.isdigit() and part.isascii() else (0, part) for part in parts]
