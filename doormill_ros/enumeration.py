"""Names in a sentence."""

from __future__ import annotations

from collections.abc import Iterable


def enumerated(names: Iterable[str], joint: str) -> str:
    """Names with commas between them and a word before the last: "rws1, rws2 and rws3".

    Args:
        names: One or more.
        joint: The word, "and" or "or".
    """
    *others, last = names
    return f"{', '.join(others)} {joint} {last}" if others else last
