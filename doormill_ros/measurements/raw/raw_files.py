"""Read what the laser tracker and the force sensor wrote; every complaint names file, line and column.

The tracker writes t, x, y, z a line, in seconds and metres (appendices A.8 to A.13 load them so). A force log
holds six readings a line in newton and newton metre, with a header that names its columns, or without one in
one of two layouts: t fx fy fz mx my mz (7 columns), or fx fy fz mx my mz in columns 1 to 6 and the time in
column 11 (A.16). Blanks, tabs, commas and semicolons separate; lines that start with # or % are comments.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.errors import DataSetError
from doormill_ros.files import NotUtf8, read_utf8
from doormill_ros.frames import WRENCH_COMPONENTS
from doormill_ros.measurements.documents.si_units import DISTANCE
from doormill_ros.measurements.errors import RawFileError

TRACKER_COLUMNS = ("t", "x", "y", "z")
_ALIASES = {"time": "t", "tx": "mx", "ty": "my", "tz": "mz"}
_A16_TIME_COLUMN = 11
#: More than any force sensor of this class reads [N], [N m]; catches millivolts and counts.
_LARGEST_READING = 1e5


@dataclass(frozen=True, eq=False)
class Recording:
    """Samples over time.

    Attributes:
        path: The file they came from.
        time: Seconds since the first sample, shape (n,).
        values: Position [m], shape (n, 3), or wrench in sensor axes [N, N m], shape (n, 6).
    """

    path: Path
    time: FloatArray
    values: FloatArray


def read_tracker_file(path: str | Path) -> Recording:
    """Read a laser tracker file: t [s], x, y, z [m] in tracker axes.

    Raises:
        RawFileError: Not readable, not four numbers a line, time going back, or not in metres.
    """
    path = Path(path)
    table = _read_table(path)
    names = _header_order(table, TRACKER_COLUMNS)
    if names is None:
        if table.width != len(TRACKER_COLUMNS):
            where = min(table.width, len(TRACKER_COLUMNS) + 1)
            problem = f"the line has {table.width} columns, a tracker file has 4 (t, x, y, z)"
            raise _error(path, table.lines[0], where, problem)
        names = {name: i for i, name in enumerate(TRACKER_COLUMNS)}
    position = table.numbers[:, [names[c] for c in "xyz"]]
    problem = (
        f"a tracker writes metres and sees no farther than {DISTANCE.largest:.0f} m; are these millimetres?"
    )
    _limit(path, table, position, [names[c] for c in "xyz"], DISTANCE.largest, problem)
    return Recording(path, _time(path, table, names["t"]), position)


def read_force_log(path: str | Path) -> Recording:
    """Read a force log: six readings [N, N m] in sensor axes, and their time [s].

    Raises:
        RawFileError: Not readable, unknown layout, time going back, or readings beyond any sensor.
    """
    path = Path(path)
    table = _read_table(path)
    names = _header_order(table, ("t", *WRENCH_COMPONENTS))
    if names is None:
        if table.width == 7:
            names = {name: i for i, name in enumerate(("t", *WRENCH_COMPONENTS))}
        elif table.width >= _A16_TIME_COLUMN:
            names = {name: i for i, name in enumerate(WRENCH_COMPONENTS)} | {"t": _A16_TIME_COLUMN - 1}
        else:
            problem = (
                f"the line has {table.width} columns; without a header a force log has 7 (t, fx ... mz) "
                f"or at least {_A16_TIME_COLUMN} (fx ... mz first, time in column {_A16_TIME_COLUMN})"
            )
            raise _error(path, table.lines[0], table.width, problem)
    columns = [names[c] for c in WRENCH_COMPONENTS]
    wrench = table.numbers[:, columns]
    _limit(path, table, wrench, columns, _LARGEST_READING, "no force sensor of this class reads that much")
    return Recording(path, _time(path, table, names["t"]), wrench)


@dataclass(frozen=True, eq=False)
class _Table:
    header: list[str] | None
    header_line: int
    lines: list[int]
    numbers: FloatArray

    @property
    def width(self) -> int:
        return int(self.numbers.shape[1])


def _error(path: Path, line: int, column: int, problem: str) -> DataSetError:
    return RawFileError(f"{path}: line {line}, column {column}: {problem}", path=str(path), line=line)


def _split(line: str) -> list[str]:
    """Cells of a line; a comma or semicolon separates alone, blanks and tabs in any number."""
    if ";" in line:
        return [cell.strip() for cell in line.rstrip().rstrip(";").split(";")]
    if "," in line:
        return [cell.strip() for cell in line.rstrip().rstrip(",").split(",")]
    return line.split()


def _read_table(path: Path) -> _Table:
    try:
        text = read_utf8(path)
    except OSError as error:
        raise _error(path, 1, 1, f"cannot be opened ({error.strerror})") from error
    except NotUtf8 as error:
        raise RawFileError(f"{path}: {error}, save it as UTF-8", path=str(path)) from error
    header: list[str] | None = None
    header_line, width = 0, 0
    lines: list[int] = []
    rows: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.lstrip()[0] in "#%":
            continue
        cells = _split(line)
        if header is None and not rows and not any(_is_number(cell) for cell in cells):
            header, header_line, width = cells, number, len(cells)
            continue
        width = width or len(cells)
        if len(cells) != width:
            problem = f"the line has {len(cells)} columns, the lines before have {width}"
            raise _error(path, number, min(len(cells), width) + 1, problem)
        rows.append([_number(path, number, column, cell) for column, cell in enumerate(cells, start=1)])
        lines.append(number)
    if not rows:
        raise _error(path, max(header_line, 1), 1, "the file holds no numbers")
    return _Table(header, header_line, lines, np.array(rows))


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return bool(re.fullmatch(r"[-+]?\d+,\d+", cell))
    return True


def _number(path: Path, line: int, column: int, cell: str) -> float:
    try:
        if "_" in cell:  # Python's own digit grouping is no number of a measuring device
            raise ValueError
        value = float(cell)
    except ValueError:
        hint = "; write a decimal point" if re.fullmatch(r"[-+]?\d+,\d+", cell) else ""
        raise _error(path, line, column, f"{cell!r} is no number{hint}") from None
    if not math.isfinite(value):
        raise _error(path, line, column, f"{cell!r} is not finite; remove the line")
    return value


def _header_order(table: _Table, wanted: tuple[str, ...]) -> dict[str, int] | None:
    """Column of each wanted name, or None when the file has no header or one that names nothing wanted."""
    if table.header is None:
        return None
    found: dict[str, int] = {}
    for i, cell in enumerate(table.header):
        # "Fx [N]" and "Fx (N)" are fx.
        name = re.split(r"[\s\[(]", cell.strip().strip('"').lower(), maxsplit=1)[0]
        found.setdefault(_ALIASES.get(name, name), i)
    if not set(wanted) <= set(found):
        return None
    return {name: found[name] for name in wanted}


def _time(path: Path, table: _Table, column: int) -> FloatArray:
    time: FloatArray = table.numbers[:, column]
    back = np.flatnonzero(np.diff(time) < 0.0)
    if back.size:
        row = int(back[0]) + 1
        problem = f"time goes back from {time[row - 1]:g} s to {time[row]:g} s"
        raise _error(path, table.lines[row], column + 1, problem)
    return time - float(time[0])


def _limit(
    path: Path, table: _Table, values: FloatArray, columns: list[int], limit: float, problem: str
) -> None:
    beyond = np.argwhere(np.abs(values) > limit)
    if beyond.size:
        row, i = beyond[0]
        raise _error(path, table.lines[row], columns[i] + 1, f"{values[row, i]:g}: {problem}")
