"""The lines of a controller's configuration file, EIO.cfg or SYS.cfg."""

from __future__ import annotations

from collections.abc import Iterable, Iterator


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
