"""Reads a CSV table of numbers; every complaint names file, line and column."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.errors import DataSetError
from doormill_ros.measurements.documents.set_document import read_text
from doormill_ros.measurements.errors import TrialTableError


class TrialTable:
    """A CSV file with a header, kept as text until a column is asked for.

    Attributes:
        path: The file.
        lines: Line number of every row, for messages.
    """

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        """Read the file and check that the columns are there and every row is complete.

        Raises:
            DataFileError: The file cannot be read.
            TrialTableError: Missing or repeated column, short or long row, no rows.
        """
        self.path = path
        reader = csv.reader(io.StringIO(read_text(path)), skipinitialspace=True)
        header: list[str] | None = None
        self.lines: list[int] = []
        rows: list[list[str]] = []
        try:
            for row in reader:
                cells = [cell.strip() for cell in row]
                if not any(cells):
                    continue
                if header is None:
                    header = cells
                    self._check_header(header, columns, reader.line_num)
                    continue
                if len(cells) != len(header):
                    where = header[len(cells)] if len(cells) < len(header) else str(len(header) + 1)
                    raise self._error(
                        reader.line_num, where, f"row has {len(cells)} cells, the header has {len(header)}"
                    )
                rows.append(cells)
                self.lines.append(reader.line_num)
        except csv.Error as error:
            raise self._error(reader.line_num, "1", f"not CSV: {error}") from error
        if header is None:
            raise self._error(
                1, columns[0], f"the file is empty, it needs a header with the columns {','.join(columns)}"
            )
        if not rows:
            raise self._error(reader.line_num or 1, columns[0], "the table holds no rows")
        self._cells = {name: [row[i] for row in rows] for i, name in enumerate(header or [])}

    def __len__(self) -> int:
        return len(self.lines)

    @property
    def columns(self) -> tuple[str, ...]:
        """All columns of the file, in its order."""
        return tuple(self._cells)

    def require(self, columns: Sequence[str]) -> None:
        """Check that further columns are there.

        Raises:
            TrialTableError: One is missing.
        """
        self._check_header(list(self._cells), columns, 1)

    def _check_header(self, header: list[str], columns: Sequence[str], line: int) -> None:
        for name in columns:
            if header.count(name) != 1:
                found = "is missing" if name not in header else "stands there twice"
                raise self._error(line, name, f"the column {found}, the header is {','.join(header)}")

    def _error(self, line: int, column: str, problem: str) -> DataSetError:
        return TrialTableError(
            f"{self.path}: line {line}, column {column}: {problem}",
            path=str(self.path),
            line=line,
            column=column,
        )

    def fail(self, row: int, column: str, problem: str) -> DataSetError:
        """The error for one cell."""
        return self._error(self.lines[row], column, problem)

    def text(self, column: str) -> list[str]:
        """Cells of a column."""
        return self._cells[column]

    def numbers(self, column: str, may_be_empty: bool = False) -> FloatArray:
        """A column as finite numbers, shape (n,); empty cells become NaN where allowed.

        Raises:
            TrialTableError: A cell is no finite number.
        """
        values = np.empty(len(self))
        for row, cell in enumerate(self._cells[column]):
            if cell == "" and may_be_empty:
                values[row] = np.nan
                continue
            try:
                values[row] = float(cell)
            except ValueError:
                raise self.fail(row, column, f"{cell!r} is no number") from None
            if not np.isfinite(values[row]):
                raise self.fail(row, column, f"{cell!r} is not finite")
        return values

    def integers(self, column: str) -> FloatArray:
        """A column as integers, shape (n,).

        Raises:
            TrialTableError: A cell is no whole number.
        """
        values = self.numbers(column)
        for row in np.flatnonzero(values != np.round(values)):
            raise self.fail(int(row), column, f"{self._cells[column][row]!r} is no whole number")
        return values.astype(int)

    def block(self, columns: Sequence[str]) -> FloatArray:
        """Several columns of numbers, shape (n, len(columns))."""
        return np.column_stack([self.numbers(column) for column in columns])
