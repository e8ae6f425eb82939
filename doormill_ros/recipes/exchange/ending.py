"""The ending of a file's name, which chooses the format."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from doormill_ros.recipes.errors import UnknownFileType


def ending_of(path: Path, allowed: Sequence[str]) -> str:
    """The ending of a name in small letters, with its dot.

    Raises:
        UnknownFileType: It is not one of those allowed.
    """
    ending = path.suffix.lower()
    if ending not in allowed:
        raise UnknownFileType(
            f"{path}: found the ending {ending!r}, allowed is one of {', '.join(allowed)}", found=ending
        )
    return ending
