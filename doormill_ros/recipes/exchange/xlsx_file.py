"""Excel workbooks with the sheets doors, tools and features."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from openpyxl import Workbook, load_workbook
from openpyxl.cell import WriteOnlyCell
from openpyxl.worksheet.worksheet import Worksheet

from doormill_ros.errors import DoormillError
from doormill_ros.recipes.errors import BadTable, UnreadableFile
from doormill_ros.recipes.exchange.cells import Row, RowKind, recipes_of, rows_of
from doormill_ros.recipes.exchange.csv_file import check_header
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.tabled_tool import LookUp

SHEETS = {record: f"{record.value}s" for record in RowKind}
MAX_BYTES = 200_000_000  #: unpacked; a small file can hold a very large table


def read_xlsx(path: Path, look_up: LookUp | None = None) -> list[Recipe]:
    """Recipes of a workbook; other sheets in it are left alone.

    Args:
        path: The file.
        look_up: Gives those of some tools that the table of tools has, by name; None where there is none.

    Raises:
        UnreadableFile: Not a workbook, or unpacks to more than 200 MB.
        BadTable: A sheet, its header or a row is wrong.
        FieldError: A recipe is wrong; the message says in which row.
    """
    try:
        rows = _unpacked(path)
    except DoormillError:
        raise
    except Exception as error:  # archive, XML and number formats each let errors of their own through
        raise UnreadableFile(f"{path}: not an Excel workbook, {error}") from error
    return recipes_of(rows, str(path), look_up)


def _unpacked(path: Path) -> list[Row]:
    with zipfile.ZipFile(path) as archive:
        size = sum(item.file_size for item in archive.infolist())
    if size > MAX_BYTES:
        raise UnreadableFile(f"{path}: unpacks to {size} bytes, allowed are {MAX_BYTES}")
    book = load_workbook(path, read_only=True, data_only=True)
    rows: list[Row] = []
    try:
        for record, sheet in SHEETS.items():
            if sheet not in book.sheetnames:
                raise BadTable(f"{path}: the sheet {sheet!r} is missing, found are {book.sheetnames}")
            rows += _rows(book[sheet], record, str(path))
    finally:
        book.close()
    return rows


def _rows(sheet: Any, record: RowKind, name: str) -> list[Row]:
    rows: list[Row] = []
    columns: list[str] = []
    for number, cells in enumerate(sheet.iter_rows(values_only=True), start=1):
        if all(cell is None for cell in cells):
            continue
        if not columns:
            columns = check_header(cells, f"{name} sheet {sheet.title}", ("door_id",))
            continue
        place = f"sheet {sheet.title} row {number}"
        content = {}
        for index, cell in enumerate(cells):
            if cell is None or cell == "":
                continue
            column = columns[index] if index < len(columns) else ""
            if not column:
                raise BadTable(f"{name} {place}: found {cell!r} in a column without a name")
            content[column] = cell
        rows.append(Row(record, content, place))
    return rows


def format_xlsx(recipes: Sequence[Recipe]) -> bytes:
    """Content of a workbook; `read_xlsx` gives equal recipes."""
    book = Workbook(write_only=True)
    everything = [row for recipe in recipes for row in rows_of(recipe)]
    for record, title in SHEETS.items():
        sheet = book.create_sheet(title)
        sheet.freeze_panes = "B2"
        rows = [row.cells for row in everything if row.record is record]
        columns = list(dict.fromkeys(column for row in rows for column in row))
        sheet.append([_cell(sheet, column) for column in columns])
        for row in rows:
            sheet.append([_cell(sheet, row.get(column)) for column in columns])
    stream = io.BytesIO()
    book.save(stream)
    return stream.getvalue()


def _cell(sheet: Worksheet, value: Any) -> Any:
    if not isinstance(value, str) or value == "":
        return value if value != "" else None
    cell = WriteOnlyCell(sheet, value)
    cell.data_type = "s"  # text that starts with = is not a formula
    return cell
