"""One kind of input with the function that reads it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

Read = Callable[[Path], object]


@dataclass(frozen=True)
class Subject:
    """One kind of input.

    Attributes:
        name: For the table.
        folder: Holds the good input, and whatever stands beside it.
        file: The one in it that is made bad.
        read: Takes the path of that file.
        named: Whether the reader knows the file's name, and so has to say it.
    """

    name: str
    folder: Path
    file: str
    read: Read
    named: bool = True


def text_folder(folder: Path, name: str, text: str | bytes) -> Path:
    """A folder with that file in it."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(text.encode() if isinstance(text, str) else text)
    return folder
