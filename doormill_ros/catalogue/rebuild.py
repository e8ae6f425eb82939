"""Fill the catalogue from bags and inspections on a disk."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from doormill_ros.catalogue.bag_rows import is_text, read_inspection_row, read_rows
from doormill_ros.catalogue.database import Catalogue
from doormill_ros.catalogue.retention import RETIRED
from doormill_ros.cell.output.inspection_files import DESCRIPTION
from doormill_ros.errors import DoormillError
from doormill_ros.recording.bag_folders import bags_in, is_bag


@dataclass(frozen=True)
class Filled:
    """What came of one bag or inspection.

    Attributes:
        path: Which.
        runs: How many runs of it are in the catalogue now.
        refused: Why it is not, or not all of it; empty where it is.
    """

    path: Path
    runs: int = 0
    refused: str = ""


def rebuild(catalogue: Catalogue, places: Iterable[Path]) -> Iterator[Filled]:
    """Put every bag and every inspection in the places into the catalogue, each for itself.

    What is refused does not keep the others out, and what was done stays when somebody ends it in between. Runs whose
    bags lie elsewhere stay as they are. A bag or an inspection that is no longer in its place is forgotten, where it is
    of a cell of which another bag lies in that place, or something else in the places.

    Raises:
        CatalogueError: The catalogue itself cannot be used.
    """
    places = list(places)
    found = [_inspections(place) for place in places]
    inspections = sorted({folder for there, _ in found for folder in there})
    cells: set[str] = set()
    cell_of: dict[Path, set[str]] = {}
    bags = bags_in(places)
    for bag in bags:
        if not is_bag(bag) and any(folder.is_relative_to(bag) for folder in inspections):
            continue  # a gauge's folder, without bags
        try:
            rows = read_rows(bag)
        except DoormillError as error:
            yield Filled(bag, 0, error.message)
            continue
        catalogue.store(rows.bag, rows.runs, rows.inspections)
        cell_of[bag] = {run.cell for run in rows.runs}
        cells |= cell_of[bag]
        nothing = "" if rows.runs else f"bag {bag} holds no run; delete it if that is right"
        yield Filled(bag, len(rows.runs), rows.refused or nothing)
    for folder in inspections:
        try:
            inspection = read_inspection_row(folder)
        except DoormillError as error:
            yield Filled(folder, 0, error.message)
            continue
        catalogue.store("", (), (inspection,))
        cells |= catalogue.cell_of(inspection.run_id)
    for place, (there, whole) in zip(places, found, strict=True):
        if whole and is_text(place.resolve()):
            # Whether it can be read or not, it is there.
            catalogue.forget_inspections(str(place.resolve()), {str(one.resolve()) for one in there}, cells)
            of_place = {cell for bag, one in cell_of.items() if bag.is_relative_to(place) for cell in one}
            left = {str(bag.resolve()) for bag in bags} | _half_deleted(place)
            catalogue.forget_bags(str(place.resolve()), left, of_place)


def _half_deleted(place: Path) -> set[str]:
    """Bags whose deletion was broken off: to finish it, `retain` has to know them."""
    left = [Path(name) for name, _, _ in os.walk(place) if name.endswith(RETIRED)]
    return {str(path.resolve().with_name(path.name[1:].removesuffix(RETIRED))) for path in left}


def _inspections(place: Path) -> tuple[list[Path], bool]:
    """Folders of inspections at any depth, and whether every folder could be looked into."""
    closed: list[OSError] = []
    found = [Path(name) for name, _, files in os.walk(place, onerror=closed.append) if DESCRIPTION in files]
    return found, not closed
