"""Reads the inspection of a milled door: inspection.yaml and points.csv beside the bag of the run.

`points.csv` has one measured point a row: the feature of the recipe, the surface (wall or floor), the nominal point
and its unit normal into the wood in the door frame, and how far the real surface lies along that normal.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.cell.output.inspection_files import BESIDE_BAG, DESCRIPTION, TABLE
from doormill_ros.errors import DataSetError
from doormill_ros.measurements.documents.schemas import INSPECTION
from doormill_ros.measurements.documents.set_document import SetDocument
from doormill_ros.measurements.documents.trial_table import TrialTable

SURFACES = ("wall", "floor")
POINT_COLUMNS, NORMAL_COLUMNS = ("x", "y", "z"), ("nx", "ny", "nz")
COLUMNS = ("feature", "surface", *POINT_COLUMNS, *NORMAL_COLUMNS, "deviation")
KEYS = ("schema", "run_id", "bag", "measured_at", "noise", "datum")
CAMERA = "camera"  #: datum: where the recorded pose put the door
PART = "part"  #: datum: the door itself, position and angle best fitted
FEATURE = "feature "  #: datum: begins the name of a feature of that door
YEARS = range(1970, 2038)  #: whose seconds fit into a stamp of ROS
NOISES = 1e-8, 1e-3  #: standard deviation of a gauge, least and largest [m]
FARTHEST = 0.1  #: that a point may be off, its gauge slipped or not [m]
#: That points may be off in the middle: no door is as far beside its place, a file in millimetres is [m].
MIDDLE = 5e-3
SIZE = 10.0  #: of a door, at most [m]
_NORMAL_TOLERANCE = 1e-3


@dataclass(frozen=True, eq=False)
class Inspection:
    """Measured points of one door.

    Attributes:
        path: The folder.
        run_id: The run that milled the door.
        bag: Its bag.
        measured_at: When it was measured, in UTC; without a zone in the file it is taken for that.
        noise: Standard deviation of one deviation [m].
        datum: What the deviations are against: "camera", "part" or "feature NAME".
        feature: Name in the recipe of each of n points.
        wall: Which points lie on a wall, the others on a floor; shape (n,).
        point: Nominal points, door frame, shape (n, 3) [m].
        normal: Unit normals there, from the pocket into the wood, door axes, shape (n, 3).
        deviation: How far the real surface lies along the normal, shape (n,) [m]; positive where too much wood is gone.
        document, table: What was read, for complaints about it.
    """

    path: Path
    run_id: str
    bag: Path
    measured_at: datetime
    noise: float
    datum: str
    feature: tuple[str, ...]
    wall: BoolArray
    point: FloatArray
    normal: FloatArray
    deviation: FloatArray
    document: SetDocument
    table: TrialTable

    @property
    def name(self) -> str:
        """What the door is called: its folder, or the run's where the inspection lies in one as `cell` makes it."""
        return self.path.resolve().parent.name if self.path.name == BESIDE_BAG else self.path.name

    def __len__(self) -> int:
        return len(self.deviation)

    @property
    def largest(self) -> float:
        """How far the worst point is off [m]."""
        return float(np.abs(self.deviation).max())

    def refuse(self, key: str, problem: str) -> DataSetError:
        """The error for a value of inspection.yaml, with line and column."""
        return self.document.fail((key,), problem)

    def refuse_point(self, row: int, column: str, problem: str) -> DataSetError:
        """The error for a cell of points.csv, with line and column."""
        return self.table.fail(row, column, problem)


def nowhere(run_id: str) -> Path | None:
    """Where the bag of a run lies, for who knows of none."""
    return None


def read_inspection(folder: Path, bag_of: Callable[[str], Path | None] = nowhere) -> Inspection:
    """Read one inspection.

    Args:
        folder: That holds it.
        bag_of: Where the bag of a run lies whose inspection names none that is there.

    Raises:
        DataSetError: A file is missing, or a value cannot be used; the message names file, line and column.
    """
    document = SetDocument(folder / DESCRIPTION)
    for key in document.data:
        if key not in KEYS:
            raise document.fail((str(key),), f"is unknown, allowed are {', '.join(KEYS)}")
    document.check_schema(INSPECTION)
    run_id = document.text("run_id")
    bag = _bag(document, folder, run_id, bag_of)
    datum = document.get("datum")
    if not isinstance(datum, str) or (datum not in (CAMERA, PART) and not datum.startswith(FEATURE)):
        raise document.fail(("datum",), f"is {datum!r}, allowed are camera, part and feature NAME")
    measured_at = _time(document.get("measured_at"))
    if measured_at is None:
        raise document.fail(
            ("measured_at",),
            f"is {document.get('measured_at')!r}, allowed is a time as 2026-11-22T08:00:00Z of the years "
            f"{YEARS[0]} to {YEARS[-1]}",
        )
    noise = document.number("noise", positive=True)
    if not NOISES[0] <= noise <= NOISES[1]:
        raise document.fail(("noise",), f"is {noise:g}, allowed are {NOISES[0]:g} to {NOISES[1]:g} m")
    table = TrialTable(folder / TABLE, COLUMNS)
    surface = table.text("surface")
    for row, name in enumerate(surface):
        if name not in SURFACES:
            raise table.fail(row, "surface", f"is {name!r}, allowed are {' and '.join(SURFACES)}")
    normal = table.block(NORMAL_COLUMNS)
    length = np.linalg.norm(normal, axis=1)
    for wrong in np.flatnonzero(np.abs(length - 1.0) > _NORMAL_TOLERANCE):
        raise table.fail(int(wrong), "nx", f"the normal has length {length[wrong]:.4f}, allowed is 1")
    return Inspection(
        path=folder,
        run_id=run_id,
        bag=bag,
        measured_at=measured_at,
        noise=noise,
        datum=datum,
        feature=tuple(table.text("feature")),
        wall=np.array(surface) == "wall",
        point=_point(table),
        normal=normal,
        deviation=_deviation(table),
        document=document,
        table=table,
    )


def _bag(document: SetDocument, folder: Path, run_id: str, bag_of: Callable[[str], Path | None]) -> Path:
    """The folder that is named, else the one that is known of the run."""
    named = document.data.get("bag")
    if isinstance(named, str) and (folder / named).is_dir():
        return folder / named
    found = bag_of(run_id) if named is None or isinstance(named, str) else None
    if found is None:
        raise document.fail(
            ("bag",),
            f"is {'missing' if named is None else repr(named)}, and no bag of run {run_id!r} is known to the "
            "catalogue; name the folder of its bag, relative to this one",
        )
    return found


def _point(table: TrialTable) -> FloatArray:
    point = table.block(POINT_COLUMNS)
    row, axis = np.unravel_index(int(np.abs(point).argmax()), point.shape)
    if abs(point[row, axis]) > SIZE:
        raise table.fail(
            int(row), POINT_COLUMNS[axis], f"is {point[row, axis]:g}, allowed is up to {SIZE:g} m"
        )
    return point


def _deviation(table: TrialTable) -> FloatArray:
    deviation = table.numbers("deviation")
    size = np.abs(deviation)
    row = int(size.argmax())
    if size[row] > FARTHEST or float(np.median(size)) > MIDDLE:
        allowed = f"allowed is up to {FARTHEST:g} m, in the middle of all points up to {MIDDLE:g} m"
        raise table.fail(
            row, "deviation", f"is {deviation[row]:g}, {allowed}; look whether the file is in metres"
        )
    return deviation


def _time(value: object) -> datetime | None:
    """The time that a text tells, None for a day alone, what is no time, and a year that no message can tell."""
    if not isinstance(value, str) or len(value) <= len("2026-11-22"):
        return None
    try:
        time = datetime.fromisoformat(value)
        time = (time if time.tzinfo else time.replace(tzinfo=UTC)).astimezone(UTC)
    except (ValueError, OverflowError):
        return None
    return time if time.year in YEARS else None


def inspections_in(folder: Path, bag_of: Callable[[str], Path | None] = nowhere) -> list[Inspection]:
    """The inspection that a folder is, or those in its folders or in `inspection` there, in the order of their names.

    Args:
        folder: To look in.
        bag_of: As of `read_inspection`.

    Raises:
        DataSetError: There is none, or one cannot be read.
    """
    if (folder / DESCRIPTION).is_file():
        return [read_inspection(folder, bag_of)]
    patterns = (f"*/{DESCRIPTION}", f"*/{BESIDE_BAG}/{DESCRIPTION}")
    within = sorted(path.parent for pattern in patterns for path in folder.glob(pattern))
    # Of a folder without any the complaint is that its own description is missing.
    return [read_inspection(path, bag_of) for path in within or [folder]]
