"""The thesis' text table: feature and door data saved from Excel with tabs between the cells.

Section 3.8 of the thesis lists what the file holds (width, height and thickness of the door,
number and position of the hinges, force displacement, hinge geometry, tooling speed and feed
rate) and that rows and columns are read by their place; it does not print a file. Here a row
starts with its label, so that the order does not matter. Further labels carry the rest of a
recipe; when they are absent the values of the thesis' experiments are taken.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from doormill_ros.recipes.errors import BadTable, FieldError, NotExpressible, UnreadableFile
from doormill_ros.recipes.exchange.cells import NUMBER, format_number
from doormill_ros.recipes.program import Program, fits_path_20
from doormill_ros.recipes.reading import located
from doormill_ros.recipes.recipe import SCHEMA, Recipe

# Label, path in the document of the whole table; a leading * is a field that all hinges share.
TEXTS = {
    "Door ID": "door_id",
    "Bar Code": "bar_code",
    "Author": "author",
    "Created": "created",
    "Hinge Side": "hinge_side",
    "Material": "material",
    "Robot Program": "program",
    "Tool": "*tool",
    "Milling Direction": "*direction",
}
NUMBERS = {
    "Version": "version",
    "Door Width": "width_mm",
    "Door Height": "height_mm",
    "Door Thickness": "thickness_mm",
    "Door Mass": "mass_kg",
    "Placement Y": "placement.y_mm",
    "Placement Z": "placement.z_mm",
    "Placement Rotation": "placement.rotation_deg",
    "Tooling Speed": "*cutting.spindle_speed_rpm",
    "Feed-Rate": "*cutting.feed_mm_s",
    "Surface Speed": "*cutting.surface_speed_m_min",
    "Chip Load": "*cutting.chip_load_mm",
    "Plunge Feed": "*cutting.plunge_feed_mm_s",
    "Depth Step": "*passes.depth_step_mm",
    "Finish Allowance": "*passes.finish_allowance_mm",
    "Wrench Point": "*wrench_point_mm",
    "Tool Diameter": "tool.diameter_mm",
    "Tool Flutes": "tool.flutes",
    "Tool Cutting Length": "tool.cutting_length_mm",
    "Tool Max Speed": "tool.max_spindle_speed_rpm",
    "Tool Max Chip Load": "tool.max_chip_load_mm",
    "Tool Min Chip Load": "tool.min_chip_load_mm",
    "Tool Min Surface Speed": "tool.min_surface_speed_m_min",
    "Tool Max Surface Speed": "tool.max_surface_speed_m_min",
    "Tool Max Ramp": "tool.max_ramp_deg",
}
SWITCHES = {"Tool Centre Cutting": "tool.centre_cutting"}
WORDS = {"yes": True, "no": False}
COUNT, POSITION, GEOMETRY = "Number of Hinges", "Hinge Position", "Hinge Geometry"
GEOMETRY_KEYS = ("backset_mm", "width_mm", "length_mm", "depth_mm", "points")
DISPLACEMENT, FORCE = "Hinge Force Displacement", "Milling Force"
NEEDED = ("Door Width", "Door Height", "Door Thickness", COUNT, POSITION)
WHOLE = ("version", "tool.flutes", "points")

# What the thesis milled with (sections 3.8 and 3.9, tables 4.8 and 4.9) where a table is silent.
GEOMETRY_DEFAULT = (25.0, 30.0, 120.0, 5.0, 6.0)
TOOL_DEFAULT = {"diameter_mm": 19.0, "flutes": 2, "cutting_length_mm": 60.0, "max_spindle_speed_rpm": 18000.0}
FORCE_DEFAULT = {
    "left_line": [-209.0, 29.0, 12.0, -5.0, -43.0, 3.0],
    "top_turn": [-100.0, 13.0, 25.0, -3.0, -26.0, 2.0],
    "right_line": [-62.0, 3.0, -11.0, -1.0, -8.0, 2.0],
    "bottom_turn": [-13.0, 2.0, -22.0, -1.0, 4.0, 0.0],
    "default": [0.0] * 6,
}
#: What is known of them, as in config/recipes: `doormill_ros.recipes.force_origin` says why.
FORCE_ORIGIN = {
    "model": "table",
    "axes": "feature",
    "measured": True,
    "std_n_nm": [96.0, 12.0, 19.0, 1.0, 5.0, 2.0],
    "source": "thesis, table 4.8, five-second means of appendix A.16",
}
WRENCH_POINT_DEFAULT = 208.0
DENSITY_DEFAULT = 450.0  #: kg/m^3, softwood


def decode(content: bytes, name: str) -> str:
    """Text of a file that Excel saved: UTF-8, UTF-16 ("Unicode text") or Windows-1252.

    Args:
        content: What is in the file.
        name: Its name, for messages.

    Raises:
        UnreadableFile: Not text.
    """
    try:
        if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
            return content.decode("utf-16")
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        pass
    try:
        return content.decode("cp1252")
    except UnicodeDecodeError as error:
        raise UnreadableFile(
            f"{name}: not a text file (byte {error.start}), save it as UTF-8 text"
        ) from error


def parse_thesis_text(text: str, name: str, door_id: str) -> Recipe:
    """The recipe of a text table.

    Args:
        text: The table.
        name: File name, for messages.
        door_id: Door id when the table has none.

    Raises:
        BadTable: A row is unknown, missing, given twice, or has the wrong number of cells.
        FieldError: The recipe is wrong.
    """
    rows = _rows(text, name)
    document: dict[str, Any] = {"schema": SCHEMA, "door_id": door_id}
    shared: dict[str, Any] = {}
    for labels, convert in ((TEXTS, _one_text), (NUMBERS, _one_number), (SWITCHES, _one_switch)):
        for label, path in labels.items():
            if label in rows:
                target = shared if path.startswith("*") else document
                _put(target, path.lstrip("*"), convert(rows[label], path, f"{name} row {label!r}"))
    _defaults(document, shared)
    tool = shared.setdefault("tool", "mill_19")
    document["tools"] = {tool: document.pop("tool")}
    document["features"] = _hinges(rows, shared, name)
    try:
        recipe = Recipe.from_document(document)
    except FieldError as error:
        raise located(error, name) from error
    # The thesis' own table has no such row, as there is only one program.
    theirs = "program" not in document and fits_path_20(recipe.features)
    return replace(recipe, program=Program.PATH_20) if theirs else recipe


def _rows(text: str, name: str) -> dict[str, list[str]]:
    known = {label.lower(): label for label in (*TEXTS, *NUMBERS, *SWITCHES, COUNT, POSITION, GEOMETRY)}
    rows: dict[str, list[str]] = {}
    for number, line in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), start=1):
        label, *cells = line.split("\t")
        while cells and cells[-1] == "":
            cells.pop()
        label = " ".join(label.split()).rstrip(": ")
        if not label and not cells:
            continue
        variable = label.lower().startswith((DISPLACEMENT.lower(), FORCE.lower()))
        if not variable and label.lower() not in known:
            raise BadTable(f"{name} row {number}: found the label {label!r}, which no row of the table has")
        key = label if variable else known[label.lower()]
        if key in rows:
            raise BadTable(f"{name} row {number}: the label {label!r} is there twice")
        rows[key] = cells
    for label in NEEDED:
        if label not in rows:
            raise BadTable(f"{name}: the row {label!r} is missing")
    return rows


def _hinges(rows: dict[str, list[str]], shared: dict[str, Any], name: str) -> list[dict[str, Any]]:
    count = _one_number(rows[COUNT], "version", f"{name} row {COUNT!r}")
    positions = _numbers(rows[POSITION], f"{name} row {POSITION!r}")
    if len(positions) != count:
        raise BadTable(f"{name} row {POSITION!r}: found {len(positions)} positions for {count} hinges")
    sizes = _numbers(rows[GEOMETRY], f"{name} row {GEOMETRY!r}") if GEOMETRY in rows else GEOMETRY_DEFAULT
    if len(sizes) != len(GEOMETRY_KEYS):
        raise BadTable(
            f"{name} row {GEOMETRY!r}: found {len(sizes)} cells, allowed are {', '.join(GEOMETRY_KEYS)}"
        )
    geometry = dict(zip(GEOMETRY_KEYS, sizes, strict=True))
    geometry["points"] = int(geometry["points"])
    shared["passes"] = {"depth_step_mm": geometry["depth_mm"], **shared.get("passes", {})}
    wrenches = _variable_rows(rows, FORCE, name)
    wrench = {label.lower().replace(" ", "_"): cells for label, cells in wrenches.items()}
    displacement = _variable_rows(rows, DISPLACEMENT, name)
    hinges = []
    for index, position in enumerate(positions, start=1):
        hinge = {"kind": "hinge_oblong", "id": f"hinge_{index}", "side": "front", "height_mm": position}
        # Of other forces than table 4.8 the table says neither who measured them nor in which axes.
        table = wrench or FORCE_DEFAULT
        forces: dict[str, Any] = {"forces": FORCE_ORIGIN} if table == FORCE_DEFAULT else {}
        hinge |= {**geometry, **shared, "wrench_n_nm": table, **forces}
        y, z = (displacement.pop(f"{index} {axis}", None) for axis in "YZ")
        if y is not None and z is not None and len(y) == len(z):
            hinge["force_displacement_mm"] = [list(pair) for pair in zip(y, z, strict=True)]
        elif y is not None or z is not None:
            raise BadTable(f"{name}: '{DISPLACEMENT} {index} Y' and '... Z' must have a cell for each point")
        hinges.append(hinge)
    if displacement:
        label = f"{DISPLACEMENT} {next(iter(displacement))}"
        raise BadTable(f"{name}: found the row {label!r}, allowed are hinges 1 to {count}, Y and Z")
    return hinges


def _variable_rows(rows: dict[str, list[str]], start: str, name: str) -> dict[str, list[float]]:
    found = {}
    for label, cells in rows.items():
        if label.lower().startswith(start.lower()):
            found[label[len(start) :].strip()] = _numbers(cells, f"{name} row {label!r}")
    return found


def _defaults(document: dict[str, Any], shared: dict[str, Any]) -> None:
    document.setdefault("bar_code", document["door_id"])
    document.setdefault("hinge_side", "right")
    document.setdefault("material", "softwood")
    if "mass_kg" not in document:
        volume = document["width_mm"] * document["height_mm"] * document["thickness_mm"] * 1e-9
        document["mass_kg"] = round(DENSITY_DEFAULT * volume, 3)
    if "tool" not in document:
        document["tool"] = dict(TOOL_DEFAULT)
    document["tool"].setdefault("centre_cutting", True)
    if "cutting" not in shared:
        shared["cutting"] = {"spindle_speed_rpm": 3200.0, "feed_mm_s": 50.0}
    shared.setdefault("wrench_point_mm", WRENCH_POINT_DEFAULT)


def _put(document: dict[str, Any], path: str, value: Any) -> None:
    *parents, leaf = path.split(".")
    for parent in parents:
        document = document.setdefault(parent, {})
    document[leaf] = value


def _get(document: dict[str, Any], path: str) -> Any:
    for part in path.split("."):
        document = document.get(part, {})
    return None if document == {} else document


def _one_text(cells: list[str], path: str, where: str) -> str:
    if len(cells) != 1:
        raise BadTable(f"{where}: found {len(cells)} cells behind the label, allowed is 1")
    return cells[0]


def _one_switch(cells: list[str], path: str, where: str) -> bool:
    word = _one_text(cells, path, where).strip().lower()
    if word not in WORDS:
        raise BadTable(f"{where}: found {cells[0]!r}, allowed is {' or '.join(WORDS)}")
    return WORDS[word]


def _one_number(cells: list[str], path: str, where: str) -> float:
    if len(cells) != 1:
        raise BadTable(f"{where}: found {len(cells)} cells behind the label, allowed is 1")
    found = _numbers(cells, where)[0]
    return int(found) if path in WHOLE and found.is_integer() else found


def _numbers(cells: list[str], where: str) -> list[float]:
    """Numbers of a row; 1,5 and 1.5 both stand for one and a half."""
    numbers = []
    for cell in cells:
        text = cell.strip().replace(",", ".")
        if not NUMBER.fullmatch(text):
            raise BadTable(f"{where}: found {cell!r}, allowed is a number")
        numbers.append(float(text))
    return numbers


def format_thesis_text(recipe: Recipe) -> str:
    """The text table of a recipe; `parse_thesis_text` gives an equal recipe.

    Raises:
        NotExpressible: The door has more than equal oblong hinges on its front.
    """
    document = recipe.to_document()
    hinges = document["features"]
    own = ("id", "height_mm", "force_displacement_mm")
    first = {key: value for key, value in hinges[0].items() if key not in own}
    for index, hinge in enumerate(hinges, start=1):
        same = {key: value for key, value in hinge.items() if key not in own} == first
        plain = hinge["kind"] == "hinge_oblong" and hinge["side"] == "front"
        if not (plain and same and hinge["height_from"] == "bottom" and hinge["id"] == f"hinge_{index}"):
            raise NotExpressible(
                f"feature {hinge['id']!r} of door {recipe.door_id!r} has no place in the thesis' text table, "
                "allowed are equal oblong hinges hinge_1, hinge_2, ... on the front, heights from the bottom"
            )
    if first["tool"] not in document["tools"]:
        raise NotExpressible(
            f"the tool {first['tool']!r} of door {recipe.door_id!r} has no place in the thesis' text table, allowed "
            "are tools of the recipe's own; export to another format"
        )
    document["tool"] = document["tools"][first["tool"]]
    lines: list[tuple[str, list[Any]]] = []
    write: Callable[[str, list[Any]], None] = lambda label, cells: lines.append((label, cells))  # noqa: E731
    for label, path in {**TEXTS, **NUMBERS, **SWITCHES}.items():
        value = _get(first if path.startswith("*") else document, path.lstrip("*"))
        if value is not None and value != "":
            write(label, [value])
    write(COUNT, [len(hinges)])
    write(POSITION, [hinge["height_mm"] for hinge in hinges])
    write(GEOMETRY, [first[key] for key in GEOMETRY_KEYS])
    if first.get("forces") != (FORCE_ORIGIN if first.get("wrench_n_nm") == FORCE_DEFAULT else None):
        raise NotExpressible(
            f"the forces of door {recipe.door_id!r} have no place in the thesis' text table, allowed are those "
            "of table 4.8 as the shipped doors have them, or other wrenches without 'forces'"
        )
    for segment, cells in first["wrench_n_nm"].items():
        write(f"{FORCE} {segment.replace('_', ' ').title()}", cells)
    for index, hinge in enumerate(hinges, start=1):
        for column, axis in enumerate("YZ"):
            if "force_displacement_mm" in hinge:
                write(f"{DISPLACEMENT} {index} {axis}", [p[column] for p in hinge["force_displacement_mm"]])
    return "".join(f"{label}\t" + "\t".join(_cell(c) for c in cells) + "\n" for label, cells in lines)


def _cell(value: Any) -> str:
    if isinstance(value, bool):
        return next(word for word, meant in WORDS.items() if meant is value)
    return format_number(value) if isinstance(value, int | float) else str(value)
