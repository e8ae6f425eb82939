"""Bags as folders on a disk: where they lie, what they hold in bytes and as a checksum."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from doormill_ros.recording.bag_reader import bag_files
from doormill_ros.recording.metadata import INFORMATION, METADATA

T = TypeVar("T")
_HEAD = 4096  # bytes of metadata.yaml in which its key stands


@dataclass(frozen=True)
class BagContent:
    """What the files of a bag hold.

    Attributes:
        sha256: Over the checksums of its .mcap files, in their order; empty where there is none.
        size: Of them [bytes].
    """

    sha256: str = ""
    size: int = 0


def is_bag(folder: Path) -> bool:
    """True for a folder with .mcap files, or with the metadata of a bag that has lost them."""
    try:
        if any(folder.glob("*.mcap")):
            return True
        with (folder / METADATA).open("rb") as stream:
            return INFORMATION.encode() in stream.read(_HEAD)
    except OSError:
        return False


def bags_in(places: Iterable[Path]) -> list[Path]:
    """Bags that the places are or hold at any depth, each once, in the order of their names; no link is followed.

    A place without any stands for itself, so that whoever reads it says what is wrong with it.
    """
    found: dict[Path, None] = {}
    for place in places:
        inside = sorted(
            path
            for name, _, _ in os.walk(place)
            if not (path := Path(name)).name.startswith(".") and is_bag(path)
        )
        found.update(dict.fromkeys(inside or [place]))
    return list(found)


def newest_bags(place: Path) -> list[Path]:
    """Bags at any depth below a place, the one that was written to last first; none where nothing is there."""
    written: dict[Path, float] = {}
    # Unlike rglob it passes over folders that vanish meanwhile.
    for name, _, files in os.walk(place):
        folder = Path(name)
        for file in (folder / one for one in files if one.endswith(".mcap")):
            try:
                written[folder] = max(written.get(folder, 0.0), file.stat().st_mtime)
            except OSError:
                continue
    return sorted(written, key=lambda folder: written[folder], reverse=True)


def size_of_bag(folder: Path) -> int:
    """Size of the .mcap files of a bag, whole or being written [bytes].

    Raises:
        OSError: One was removed at this moment.
    """
    return sum(file.stat().st_size for file in folder.glob("*.mcap"))


def latest_in_bags(
    place: Path, runs_of: Callable[[Path], Mapping[str, T] | None], since: str, enough: int
) -> dict[str, T]:
    """Runs by id from the bags at any depth below a place, those that were written to last first, until it is enough.

    Args:
        place: The folder; it need not be there yet.
        runs_of: Runs of a bag by id; None for a bag that says nothing.
        since: The first run that counts; empty: all do.
        enough: So many runs are, or so many bags one after another whose runs are all earlier.
    """
    found: dict[str, T] = {}
    before = 0
    for bag in newest_bags(place):
        runs = runs_of(bag)
        if runs is None:
            continue
        wanted = {run_id: run for run_id, run in runs.items() if run_id >= since}
        found = wanted | found
        before = before + 1 if runs and not wanted else 0
        if len(found) >= enough or before >= enough:
            break
    return found


def content_of_bag(folder: Path) -> BagContent:
    """Checksum and size of a bag.

    Raises:
        OSError: A file cannot be read.
    """
    whole, size = hashlib.sha256(), 0
    files = bag_files(folder)
    for path in files:
        with path.open("rb") as stream:
            whole.update(hashlib.file_digest(stream, "sha256").digest())
            size += stream.tell()
    return BagContent(whole.hexdigest() if files else "", size)
