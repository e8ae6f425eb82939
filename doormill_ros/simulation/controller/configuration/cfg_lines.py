"""The lines of a controller's configuration file, EIO.cfg or SYS.cfg."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path


def lines_of(path: Path, refused: Callable[[str], Exception]) -> list[str]:
    """The lines of a configuration file.

    Args:
        path: The file.
        refused: Makes the error of a file that is no plain text from its sentence, which names the byte.
    """
    try:
        return path.read_text(encoding="ascii").splitlines()
    except UnicodeDecodeError as error:
        raise refused(f"{path}: byte {error.start} is no ASCII, allowed is plain text: save it so") from error


def entries(lines: Iterable[str], first: int = 1) -> Iterator[tuple[int, str]]:
    """Number of the line on which each entry begins, and the entry; without blank lines and comments.

    Args:
        lines: Of the file; a backslash at the end of one continues it.
        first: Number of the first of them.
    """
    pending, start = "", 0
    for number, text in enumerate(lines, first):
        start = start if pending else number
        pending += text.strip()
        if pending.endswith("\\"):
            pending = pending[:-1] + " "
            continue
        entry, pending = pending.strip(), ""
        if entry and not entry.startswith("#"):
            yield start, entry
