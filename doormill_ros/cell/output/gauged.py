"""Inspections that the gauge of the simulated cell made, noted on its controller's disk: all others somebody measured.

What is noted is the content without the line of the bag, so that it is known again where it is kept beside another one.
"""

from __future__ import annotations

import hashlib
from contextlib import suppress
from pathlib import Path

from doormill_ros.cell.output.inspection_files import DESCRIPTION, TABLE

NOTE = "gauged.txt"  #: a line an inspection, in the folder around HOME


def note_gauged(controller: Path, description: str, table: str) -> None:
    """Note an inspection as the simulated gauge's.

    Args:
        controller: Folder around the simulated controller's HOME.
        description: Content of its inspection.yaml.
        table: Content of its points.csv.

    Raises:
        OSError: It cannot be written.
    """
    controller.mkdir(parents=True, exist_ok=True)
    with (controller / NOTE).open("a", encoding="utf-8") as stream:
        stream.write(_print_of(description, table.encode("utf-8")) + "\n")


def noted(controller: Path) -> frozenset[str]:
    """What `note_gauged` noted there; nothing where no note can be read."""
    with suppress(OSError, ValueError):
        return frozenset((controller / NOTE).read_text(encoding="utf-8").split())
    return frozenset()


def is_gauged(folder: Path, known: frozenset[str]) -> bool:
    """Whether the inspection in a folder is one of those noted."""
    with suppress(OSError, ValueError):
        description = (folder / DESCRIPTION).read_text(encoding="utf-8")
        return _print_of(description, (folder / TABLE).read_bytes()) in known
    return False


def _print_of(description: str, table: bytes) -> str:
    own = [line for line in description.splitlines() if not line.startswith("bag:")]
    return hashlib.sha256("\n".join([*own, ""]).encode("utf-8") + table).hexdigest()
