"""CSV tables: one row a door, a tool or a feature, told apart by the column `record`."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

from doormill_ros.recipes.errors import BadTable
from doormill_ros.recipes.exchange.cells import Row, RowKind, format_number, recipes_of, rows_of
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.tabled_tool import LookUp

RECORD = "record"
DELIMITERS = ";\t,"  #: a comma last: it may stand inside a number of a table with another delimiter
MAX_CELL = 1_000_000


def parse_csv(text: str, name: str, look_up: LookUp | None = None) -> list[Recipe]:
    """Recipes of a CSV text; `;`, tab or `,` between cells, with the first two also 1,5 for 1.5.

    Args:
        text: Of the file.
        name: Of the file, for messages.
        look_up: Gives those of some tools that the table of tools has, by name; None where there is none.

    Raises:
        BadTable: A row or the header is wrong.
        FieldError: A recipe is wrong; the message says in which row.
    """
    if not text.strip():
        raise BadTable(f"{name}: the file is empty, it needs a first row with the names of the columns")
    header = text.split("\n", 1)[0]
    delimiter = max(DELIMITERS, key=header.count)
    csv.field_size_limit(MAX_CELL)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    rows: list[Row] = []
    columns: list[str] = []
    try:
        for cells in reader:
            place = f"row {reader.line_num}"
            if not any(cells):
                continue
            if not columns:
                columns = check_header(cells, name, (RECORD, "door_id"))
                continue
            rows.append(_row(columns, cells, f"{name} {place}", place, delimiter != ","))
    except csv.Error as error:
        raise BadTable(f"{name} row {reader.line_num}: not CSV, {error}") from error
    return recipes_of(rows, name, look_up)


def check_header(cells: Sequence[object], name: str, needed: Sequence[str]) -> list[str]:
    """Column names, checked for doubles and for the needed ones; raises BadTable."""
    columns = ["" if cell is None else str(cell).strip() for cell in cells]
    named = [column for column in columns if column]
    doubles = sorted({column for column in named if named.count(column) > 1})
    if doubles:
        raise BadTable(f"{name}: the column {doubles[0]!r} is there twice, allowed is once")
    missing = [column for column in needed if column not in named]
    if missing:
        raise BadTable(f"{name}: the column {missing[0]!r} is missing from the first row")
    return columns


def _row(columns: list[str], cells: list[str], where: str, place: str, decimal_comma: bool) -> Row:
    if any(cells[len(columns) :]):
        raise BadTable(f"{where}: found {len(cells)} cells, allowed are {len(columns)}, one a column")
    content = {}
    for column, cell in zip(columns, cells, strict=False):
        if cell == "":
            continue
        if not column:
            raise BadTable(f"{where}: found {cell!r} in a column without a name")
        content[column] = cell
    record = content.pop(RECORD, "")
    allowed = [item.value for item in RowKind]
    if record not in allowed:
        raise BadTable(f"{where}: found {record!r} in the column {RECORD}, allowed is one of {allowed}")
    return Row(RowKind(record), content, place, decimal_comma)


def format_csv(recipes: Sequence[Recipe]) -> str:
    """CSV text of recipes; `parse_csv` gives equal ones."""
    rows = [{RECORD: row.record.value, **row.cells} for recipe in recipes for row in rows_of(recipe)]
    columns = list(dict.fromkeys(column for row in rows for column in row))
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow([_cell(row.get(column)) for column in columns])
    return stream.getvalue()


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return format_number(value) if isinstance(value, int | float) else str(value)
