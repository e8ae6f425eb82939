"""What an earlier run left in an output folder, told apart from what somebody else put there."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from doormill_ros.cell.output.gauged import is_gauged, noted
from doormill_ros.cell.output.inspection_files import BESIDE_BAG, DESCRIPTION
from doormill_ros.cell.output.schemas import RUN, SHIFT
from doormill_ros.yaml_text import parse

DOOR = re.compile(r"door_\d+")
#: Files of a run and of the tools that add to it, by their folder; a file that is being written ends in .part.
_WRITTEN = {
    "bag": re.compile(r"(metadata\.yaml|expected\.yaml|[^/]*\.mcap)(\.part)?"),
    "targets": re.compile(r"(robot\d/)?(\d{8}T\d{12}Z[^/]*\.txt|run-in-hand\.json)(\.part)?"),
    "inspection": re.compile(r"(inspection\.yaml|points\.csv)(\.part)?"),
}
_DIAGNOSIS = re.compile(r"(diagnosis\.json|model\.yaml|report\.html)(\.part)?")
_FILES = ("report.html", "summary.json", "parameters.yaml")


def is_run(root: Path) -> bool:
    """Whether a run of the cell was in a folder: its summary or the parameters of its nodes lie there."""
    return _schema(root / "summary.json") == RUN or _has_node_parameters(root / "parameters.yaml")


def is_shift(root: Path) -> bool:
    """Whether a shift of doors was milled into a folder, or begun there."""
    return _schema(root / "shift.json") == SHIFT or is_run(root) or any(is_run(path) for path in doors(root))


def is_diagnosis(folder: Path) -> bool:
    """Whether a folder holds what `diagnose` writes."""
    return str(_schema(folder / "diagnosis.json")).startswith("doormill/")


def doors(root: Path) -> list[Path]:
    """Folders of the doors of a shift, in their order."""
    return sorted(path for path in root.glob("door_*") if DOOR.fullmatch(path.name))


def strangers(root: Path, ran: bool) -> Iterator[Path]:
    """What lies in the place of a run's files and folders, and no earlier run has written.

    Args:
        root: Of the run.
        ran: Whether a run was there; without one all of it is somebody else's.
    """
    for name, written in _WRITTEN.items():
        yield from (
            path for path in _files(root / name) if not ran or not _is_like(path, root / name, written)
        )
    files = (root / name for name in _FILES)
    yield from (path for path in files if _is_there(path) and not (ran and path.is_file()))


def strangers_in(folders: Iterable[Path], ran: bool) -> Iterator[Path]:
    """As `strangers`, of folders in which a run may have written anything, such as the simulated controller's disk."""
    for folder in folders:
        yield from (path for path in _files(folder) if not ran or path == folder)


def strangers_beside(root: Path) -> Iterator[Path]:
    """What lies in a folder of a door, which is removed as a whole, and is not one of a run's own names."""
    if root.is_symlink() or not root.is_dir():
        yield root
        return
    yield from (path for path in sorted(root.iterdir()) if path.name not in (*_WRITTEN, *_FILES))


def strangers_in_diagnosis(folder: Path) -> Iterator[Path]:
    """What lies beside the files of a diagnosis."""
    return (path for path in _files(folder) if not _is_like(path, folder, _DIAGNOSIS))


def handed_in(folder: Path, controller: Path) -> Iterator[Path]:
    """Descriptions of inspections below a folder that somebody may have measured.

    Args:
        folder: To look in.
        controller: Where the simulated cell noted what its own gauge measured, see `note_gauged`.
    """
    known = noted(controller)
    return (path for path in sorted(folder.rglob(DESCRIPTION)) if not is_gauged(path.parent, known))


def inspected(root: Path) -> bool:
    """Whether a folder of a door holds an inspection."""
    return (root / BESIDE_BAG / DESCRIPTION).is_file()


def _files(folder: Path) -> Iterator[Path]:
    """Everything below a folder that is no folder; the folder itself where it is none."""
    if not _is_there(folder):
        return
    if folder.is_symlink() or not folder.is_dir():
        yield folder
        return
    yield from (path for path in sorted(folder.rglob("*")) if path.is_symlink() or not path.is_dir())


def _is_like(path: Path, folder: Path, written: re.Pattern[str]) -> bool:
    return (
        path != folder
        and not path.is_symlink()
        and bool(written.fullmatch(path.relative_to(folder).as_posix()))
    )


def _is_there(path: Path) -> bool:
    return path.is_symlink() or path.exists()


def _schema(path: Path) -> Any:
    with suppress(OSError, ValueError, RecursionError):
        document = json.loads(path.read_text(encoding="utf-8"))
        return document.get("schema") if isinstance(document, dict) else None
    return None


def _has_node_parameters(path: Path) -> bool:
    with suppress(OSError, ValueError, RecursionError):
        document = parse(path.read_text(encoding="utf-8"))
        return isinstance(document, dict) and "/**/bag_recorder" in document
    return False
