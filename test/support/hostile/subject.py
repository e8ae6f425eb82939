"""One kind of input with the function that reads it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

Read = Callable[[Path], Any]
Write = Callable[[Any, Path], object]


@dataclass(frozen=True)
class Subject:
    """One kind of input.

    Attributes:
        name: For the table.
        folder: Holds the good input, and whatever stands beside it.
        file: The one in it that is made bad.
        read: Takes the path of that file.
        named: Whether the reader knows the file's name, and so has to say it.
        write: Writes what was read to a path, where the project does that itself.
        quiet: Whether sentences must not tell where, because the file holds secrets.
    """

    name: str
    folder: Path
    file: str
    read: Read
    named: bool = True
    write: Write | None = None
    quiet: bool = False


def text_folder(folder: Path, name: str, text: str | bytes) -> Path:
    """A folder with that file in it."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(text.encode() if isinstance(text, str) else text)
    return folder


def of_folder(read: Callable[[Path], Any]) -> Read:
    """For a reader that takes the folder of a file."""
    return lambda path: read(path.parent)
