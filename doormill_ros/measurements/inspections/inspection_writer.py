"""Writes the inspection of a milled door: inspection.yaml and points.csv, in a folder of their own."""

from __future__ import annotations

import os
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Protocol

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.output.inspection_files import DESCRIPTION, TABLE
from doormill_ros.files import write_atomically
from doormill_ros.measurements.documents.schemas import INSPECTION
from doormill_ros.measurements.inspections.inspection import CAMERA, COLUMNS
from doormill_ros.yaml_text import text_of


class MeasuredPoints(Protocol):
    """Columns of points.csv; see `Inspection`."""

    @property
    def feature(self) -> Sequence[str]:
        """Name in the recipe of each of n points."""
        ...

    @property
    def surface(self) -> Sequence[str]:
        """Wall or floor, n of them."""
        ...

    @property
    def point(self) -> FloatArray:
        """Nominal points, door frame, shape (n, 3) [m]."""
        ...

    @property
    def normal(self) -> FloatArray:
        """From the pocket into the wood, door axes, shape (n, 3)."""
        ...

    @property
    def deviation(self) -> FloatArray:
        """Along the normal, shape (n,) [m]; positive where too much wood is gone."""
        ...


def write_inspection(
    folder: Path,
    bag: Path,
    run_id: str,
    measured_at: datetime,
    noise: float,
    points: MeasuredPoints,
    datum: str = CAMERA,
) -> None:
    """Write both files, the description last: who finds it finds the points too.

    Args:
        folder: Made when it is missing.
        bag: Of the run.
        run_id: As of `inspection_texts`, and likewise what follows.
        measured_at: With its zone.
        noise: Standard deviation of one deviation [m].
        points: What was measured.
        datum: What it was measured against.

    Raises:
        OSError: A file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    beside = os.path.relpath(bag, folder)
    description, table = inspection_texts(beside, run_id, measured_at, noise, points, datum)
    write_atomically(folder / TABLE, table)
    write_atomically(folder / DESCRIPTION, description)


def inspection_texts(
    bag: str,
    run_id: str,
    measured_at: datetime,
    noise: float,
    points: MeasuredPoints,
    datum: str = CAMERA,
) -> tuple[str, str]:
    """Contents of inspection.yaml and points.csv.

    Args:
        bag: Of the run, relative to the inspection's folder.
        run_id: The run that milled the door.
        measured_at: With its zone.
        noise: Standard deviation of one deviation [m].
        points: What was measured.
        datum: What it was measured against; by default where the recorded pose put the door.
    """
    rows = [",".join(COLUMNS)]
    for feature, surface, point, normal, deviation in zip(
        points.feature, points.surface, points.point, points.normal, points.deviation, strict=True
    ):
        rows.append(",".join([feature, surface, *(f"{value:.9f}" for value in (*point, *normal, deviation))]))
    lines = {
        "schema": INSPECTION,
        "run_id": run_id,
        "bag": bag,
        "measured_at": f"{measured_at.astimezone(UTC):%Y-%m-%dT%H:%M:%SZ}",
        # Every digit, so that what is kept of a gauge is not another one's; with the point that YAML wants.
        "noise": text_of({"noise": float(noise)}).removeprefix("noise:").strip(),
        "datum": datum,
    }
    return "".join(f"{key}: {value}\n" for key, value in lines.items()), "\n".join(rows) + "\n"
