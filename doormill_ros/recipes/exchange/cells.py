"""Turn a recipe document into table rows with plain cells, and back.

A door becomes one door row, one row a tool and one row a feature. A column is named by the
dotted path of its field within the row, such as `cutting.feed_mm_s`. A list of numbers is one
cell with blanks between them. An empty cell is an absent field.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from doormill_ros.recipes.errors import BadTable, DuplicateName, FieldError
from doormill_ros.recipes.features.registry import FEATURES
from doormill_ros.recipes.quantities import Choice
from doormill_ros.recipes.reading import located
from doormill_ros.recipes.recipe import SCHEMA, Recipe
from doormill_ros.recipes.tabled_tool import TABLE, LookUp, completed
from doormill_ros.recipes.tool import Tool
from doormill_ros.values import Section, keys, plain

LISTS = ("wrench_n_nm.", "force_displacement_mm", "forces.std_n_nm")
TRUTH = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


class RowKind(str, Enum):
    """What a row is about; also the names of the sheets of a workbook, with an s."""

    DOOR = "door"
    TOOL = "tool"
    FEATURE = "feature"


@dataclass(frozen=True)
class Row:
    """One row of a table.

    Attributes:
        record: What it is about.
        cells: Column name to text, number or bool; empty cells are left out.
        place: Where it stands in the file, for messages.
        decimal_comma: True when the file may write 1,5 for 1.5.
    """

    record: RowKind
    cells: Mapping[str, Any]
    place: str = ""
    decimal_comma: bool = False


def rows_of(recipe: Recipe) -> list[Row]:
    """Door, tool and feature rows of a recipe, in this order; tools of the table of tools have none."""
    document = recipe.to_document()
    document.pop(TABLE, None)
    tools, features = document.pop("tools"), document.pop("features")
    door_id = {"door_id": recipe.door_id}
    rows = [Row(RowKind.DOOR, _flatten(document))]
    rows += [Row(RowKind.TOOL, {**door_id, "name": n, **_flatten(t)}) for n, t in tools.items()]
    rows += [Row(RowKind.FEATURE, {**door_id, **_flatten(f)}) for f in features]
    return rows


def recipes_of(rows: Iterable[Row], name: str, look_up: LookUp | None = None) -> list[Recipe]:
    """The checked recipes of a table.

    Args:
        rows: Rows in any order; features are milled in the order of their rows.
        name: File name, for messages.
        look_up: Gives those of some tools that the table of tools has, by name; None where there is none.

    Raises:
        BadTable: A row belongs to no door, or nothing is there.
        FieldError: A recipe is wrong; the message says in which row.
    """
    doors: dict[str, dict[str, Any]] = {}
    places: dict[str, dict[str, str]] = {}
    others = []
    for row in rows:
        if "door_id" not in row.cells:
            raise BadTable(f"{name} {row.place}: the column door_id is empty, every row needs the door's id")
        door_id = _text(row.cells["door_id"])
        if row.record is not RowKind.DOOR:
            others.append((door_id, row))
            continue
        if door_id in doors:
            raise DuplicateName("door_id", f"{name} {row.place}: door {door_id!r} has a row already")
        doors[door_id] = {"schema": SCHEMA, **_unflatten(row, name, Recipe), "tools": {}, "features": []}
        places[door_id] = {"": row.place}
    if not doors:
        raise BadTable(f"{name}: no row is about a door, at least one must be")
    for door_id, row in others:
        if door_id not in doors:
            raise BadTable(f"{name} {row.place}: door {door_id!r} has no row of its own")
        _add(doors[door_id], places[door_id], row, name)
    return [_build(document, places[door_id], name, look_up) for door_id, document in doors.items()]


def _add(document: dict[str, Any], places: dict[str, str], row: Row, name: str) -> None:
    if row.record is RowKind.TOOL:
        content = _unflatten(row, name, Tool, skip="door_id")
        tool = content.pop("name", None)
        if tool is None:
            raise BadTable(f"{name} {row.place}: the column name is empty, every tool needs a name")
        if tool in document["tools"]:
            raise DuplicateName(f"tools.{tool}", f"{name} {row.place}: the tool has a row already")
        document["tools"][tool] = content
        places[f"tools.{tool}"] = row.place
    else:
        kind = FEATURES.get(_text(row.cells.get("kind", "")))
        places[f"features.{len(document['features'])}"] = row.place
        document["features"].append(_unflatten(row, name, kind, skip="door_id"))


def _build(document: dict[str, Any], places: dict[str, str], name: str, look_up: LookUp | None) -> Recipe:
    try:
        return Recipe.from_document(completed(document, look_up))
    except FieldError as error:
        head = ".".join(error.field.split(".")[:2])
        raise located(error, f"{name} {places.get(head, places[''])}".strip()) from error


def _flatten(document: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    cells: dict[str, Any] = {}
    for key, value in document.items():
        if isinstance(value, Mapping):
            cells |= _flatten(value, f"{prefix}{key}.")
        elif isinstance(value, list):
            cells[prefix + key] = " ".join(format_number(v) for v in _numbers(value))
        else:
            cells[prefix + key] = value
    return cells


def _numbers(value: list[Any]) -> list[float]:
    return [number for item in value for number in (_numbers(item) if isinstance(item, list) else [item])]


def format_number(value: float) -> str:
    """Shortest text that reads back as the same number."""
    return str(int(value)) if value == int(value) else repr(value)


def _unflatten(row: Row, name: str, content: type | None, skip: str = "") -> dict[str, Any]:
    document: dict[str, Any] = {}
    for column, cell in row.cells.items():
        if column == skip:
            continue
        *parents, leaf = column.split(".")
        place = document
        for parent in parents:
            place = place.setdefault(parent, {})
            if not isinstance(place, dict):
                raise BadTable(
                    f"{name} {row.place}: the column {column!r} is inside {parent!r}, which has a value"
                )
        if leaf in place:
            raise BadTable(
                f"{name} {row.place}: the column {column!r} has a value, and a column inside it too"
            )
        place[leaf] = _value(cell, column, _kind_of(content, column), row.decimal_comma)
    return document


def _kind_of(content: type | None, column: str) -> Any:
    """Annotated type of a dotted column of a section, None when it has none."""
    first, _, rest = column.partition(".")
    field = keys(content).get(first) if content else None
    if field is None:
        return None
    part = plain(field.kind)
    inside = rest and isinstance(part, type) and issubclass(part, Section)
    return _kind_of(part, rest) if inside else field.kind


def _value(cell: Any, column: str, kind: Any, decimal_comma: bool) -> Any:
    """What a document would hold for a cell; a cell that makes no sense stays as it is."""
    if column.startswith(LISTS):
        numbers = [_number(part, decimal_comma) for part in str(cell).split()]
        return _pairs(numbers) if column == "force_displacement_mm" else numbers
    if kind is None:
        return cell
    part = plain(kind)
    if part is bool:
        return TRUTH.get(_text(cell).strip().lower(), cell)
    numbered = isinstance(part, type) and issubclass(part, Choice) and not issubclass(part, str)
    if part is not float and part is not int and not numbered:
        return _text(cell)
    found = _number(cell, decimal_comma)
    whole = part is not float and isinstance(found, float) and found.is_integer()
    return int(found) if whole else found


def _pairs(numbers: list[Any]) -> list[list[Any]]:
    return [numbers[index : index + 2] for index in range(0, len(numbers), 2)]


def _number(cell: Any, decimal_comma: bool) -> Any:
    if not isinstance(cell, str):
        return cell
    text = cell.strip()
    if decimal_comma:
        text = text.replace(",", ".")
    return float(text) if NUMBER.fullmatch(text) else cell


def _text(cell: Any) -> str:
    """Text of a cell; a spreadsheet makes the bar code 7040000000017 a number."""
    if isinstance(cell, bool):
        return str(cell).lower()
    if isinstance(cell, float) and cell.is_integer():
        return str(int(cell))
    return str(cell)
