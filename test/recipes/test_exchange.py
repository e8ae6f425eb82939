"""Files as people and other programs write them: Excel exports, decimal commas, mistakes."""

import csv
import io
import json
import os
import zipfile

import openpyxl
import pytest

from doormill_ros.recipes import errors as e
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.exchange.csv_file import format_csv, parse_csv
from doormill_ros.recipes.exchange.files import read_file, write_file
from doormill_ros.recipes.exchange.thesis_text import format_thesis_text, parse_thesis_text
from doormill_ros.recipes.program import Program
from doormill_ros.recipes.recipe import Recipe
from support.full_disk import room_for

MINIMAL = """Door Width\t190
Door Height\t2500
Door Thickness\t50
Number of Hinges\t2
Hinge Position\t150\t2350
Hinge Force Displacement 1 Y\t0,1\t0,2\t0,3\t-0,1\t-0,2\t-0,3
Hinge Force Displacement 1 Z\t0,01\t0,02\t0,03\t-0,01\t-0,02\t-0,03
Tooling Speed\t3200
Feed-Rate\t50
"""


@pytest.fixture
def recipe(document):
    return Recipe.from_document(document)


def table(recipe):
    return list(csv.reader(io.StringIO(format_csv([recipe]))))


def text_of(rows, delimiter=",", comma=False):
    stream = io.StringIO()
    writer = csv.writer(stream, delimiter=delimiter, lineterminator="\r\n")
    for row in rows:
        numeric = [cell.replace(".", ",") if comma and is_number(cell) else cell for cell in row]
        writer.writerow(numeric)
    return stream.getvalue()


def is_number(cell):
    return all(part.lstrip("-").replace(".", "", 1).isdigit() for part in cell.split()) and "." in cell


@pytest.mark.parametrize(("delimiter", "comma"), [(",", False), (";", False), (";", True), ("\t", True)])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_csv_of_any_excel(tmp_path, document, delimiter, comma, encoding):
    document |= {"author": "Jørgen Åsæther", "width_mm": 800.25}
    recipe = Recipe.from_document(document)
    path = tmp_path / "export.csv"
    path.write_bytes(text_of(table(recipe), delimiter, comma).encode(encoding))
    assert read_file(path) == [recipe]


def test_columns_and_rows_may_come_in_any_order(recipe):
    header, door, *rest = table(recipe)
    order = sorted(range(len(header)), key=lambda i: header[i][::-1])
    rows = [header, *[row for row in rest if row[0] == "tool"][::-1], door]
    rows += [row for row in rest if row[0] == "feature"]
    shuffled = [[row[i] for i in order] for row in rows]
    assert parse_csv(text_of(shuffled), "x.csv") == [recipe]


def spoil(rows, record, column, value):
    index = rows[0].index(column)
    row = next(row for row in rows if row[0] == record)
    row[index] = value
    return rows


@pytest.mark.parametrize(
    ("record", "column", "value", "error", "message"),
    [
        ("door", "width_mm", "12", e.OutOfRange, r"x\.csv row 2: width_mm: found 12 mm"),
        ("door", "width_mm", "wide", e.WrongType, r"row 2: width_mm: found 'wide'"),
        ("door", "width_mm", "1_000", e.WrongType, r"row 2: width_mm"),
        ("door", "width_mm", "nan", e.WrongType, r"row 2: width_mm"),
        ("door", "width_mm", "", e.MissingField, r"row 2: width_mm: is missing"),
        ("door", "placement.y_mm", "11", e.OutOfRange, r"row 2: placement\.y_mm"),
        ("door", "record", "gate", e.BadTable, r"row 2: found 'gate' in the column record"),
        ("tool", "flutes", "2.5", e.WrongType, r"row 3: tools\.mill_16\.flutes"),
        ("tool", "name", "", e.BadTable, r"row 3: the column name is empty"),
        ("tool", "door_id", "", e.BadTable, r"row 3: the column door_id is empty"),
        ("tool", "door_id", "other", e.BadTable, r"row 3: door 'other' has no row"),
        ("tool", "name", "mill_6", e.DuplicateName, r"row 4: the tool has a row already"),
        ("feature", "depth_mm", "0", e.OutOfRange, r"row 5: features\.0\.depth_mm"),
        ("feature", "kind", "", e.MissingField, r"row 5: features\.0\.kind"),
        ("feature", "kind", "gap", e.NotAChoice, r"row 5: features\.0\.kind"),
        ("feature", "points", "7", e.NotAChoice, r"row 5: features\.0\.points"),
        ("feature", "corner_radius_mm", "3", e.UnknownField, r"row 5: features\.0\.corner_radius_mm"),
        ("feature", "wrench_n_nm.default", "1 2 3", e.WrongType, r"row 5: features\.0\.wrench_n_nm\.default"),
        ("feature", "wrench_n_nm.default", "1 2 x 4 5 6", e.WrongType, r"wrench_n_nm\.default\.2"),
        ("feature", "cutting.feed_mm_s", "-1", e.OutOfRange, r"row 5: features\.0\.cutting\.feed_mm_s"),
    ],
)
def test_wrong_cell_is_named_with_its_row(recipe, record, column, value, error, message):
    with pytest.raises(error, match=message):
        parse_csv(text_of(spoil(table(recipe), record, column, value)), "x.csv")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file is empty"),
        ("door_id,width_mm\n", "the column 'record' is missing"),
        ("record,width_mm\n", "the column 'door_id' is missing"),
        ("record,door_id,door_id\n", "the column 'door_id' is there twice"),
        ("record,door_id\n", "no row is about a door"),
        ("record,door_id\ndoor,a,b\n", "found 3 cells, allowed are 2"),
        ("record,door_id,\ndoor,a,b\n", "found 'b' in a column without a name"),
        ('record,door_id\ndoor,"a\n', "not CSV"),
        ('record,door_id\ndoor,"a"b\n', "not CSV"),
    ],
)
def test_broken_tables(text, message):
    with pytest.raises(e.BadTable, match=message):
        parse_csv(text, "x.csv")


def test_two_rows_for_one_door(recipe):
    rows = table(recipe)
    with pytest.raises(e.DuplicateName, match="row 3"):
        parse_csv(text_of([rows[0], rows[1], *rows[1:]]), "x.csv")


def test_a_column_inside_a_plain_field_is_refused(recipe):
    rows = table(recipe)
    rows[0].append("width_mm.left")
    rows[1].append("3")
    with pytest.raises(e.BadTable, match=r"inside 'width_mm'"):
        parse_csv(text_of([rows[0], *[row + [""] * (len(rows[0]) - len(row)) for row in rows[1:]]]), "x.csv")


@pytest.fixture
def workbook(tmp_path, recipe):
    path = tmp_path / "recipes.xlsx"
    write_file(path, [recipe])
    return path


def edit(path, sheet, column, row, value):
    book = openpyxl.load_workbook(path)
    header = [cell.value for cell in book[sheet][1]]
    book[sheet].cell(row=row, column=header.index(column) + 1).value = value
    book.save(path)


def test_excel_may_store_a_bar_code_as_a_number(workbook):
    edit(workbook, "doors", "bar_code", 2, 7040000000017)
    assert read_file(workbook)[0].bar_code == "7040000000017"


def test_excel_may_store_numbers_as_text(workbook, recipe):
    edit(workbook, "doors", "width_mm", 2, "800")
    edit(workbook, "features", "points", 2, "6")
    assert read_file(workbook) == [recipe]


def test_other_sheets_and_empty_rows_are_left_alone(workbook, recipe):
    book = openpyxl.load_workbook(workbook)
    book.create_sheet("prices", 0)["A1"] = "nothing of ours"
    book["features"].insert_rows(3)
    book["doors"].insert_rows(1, 2)
    book.save(workbook)
    assert read_file(workbook) == [recipe]


@pytest.mark.parametrize(
    ("sheet", "column", "value", "error", "message"),
    [
        ("doors", "width_mm", 12, e.OutOfRange, "sheet doors row 2: width_mm: found 12 mm"),
        ("doors", "width_mm", "#REF!", e.WrongType, "sheet doors row 2: width_mm"),
        ("doors", "width_mm", True, e.WrongType, "sheet doors row 2: width_mm"),
        ("doors", "width_mm", "=1+1", e.MissingField, "sheet doors row 2: width_mm"),
        ("features", "depth_mm", -1, e.OutOfRange, r"sheet features row 2: features\.0\.depth_mm"),
        ("features", "door_id", "x", e.BadTable, "sheet features row 2: door 'x'"),
        ("tools", "diameter_mm", None, e.MissingField, r"sheet tools row 2: tools\.mill_16\.diameter_mm"),
    ],
)
def test_wrong_cell_of_a_workbook(workbook, sheet, column, value, error, message):
    edit(workbook, sheet, column, 2, value)
    with pytest.raises(error, match=message):
        read_file(workbook)


def test_workbook_without_a_sheet(workbook):
    book = openpyxl.load_workbook(workbook)
    del book["tools"]
    book.save(workbook)
    with pytest.raises(e.BadTable, match="the sheet 'tools' is missing"):
        read_file(workbook)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 cut short", b"record,door_id\n", b"\x00" * 100])
def test_what_is_no_workbook(tmp_path, content):
    path = tmp_path / "x.xlsx"
    path.write_bytes(content)
    with pytest.raises(e.UnreadableFile, match="not an Excel workbook"):
        read_file(path)


def test_a_zip_that_is_no_workbook(tmp_path):
    path = tmp_path / "x.xlsx"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("a.txt", "hello")
    with pytest.raises(e.UnreadableFile):
        read_file(path)


def test_thesis_table_with_nothing_but_what_the_thesis_lists(tmp_path):
    path = tmp_path / "narrow.txt"
    path.write_text(MINIMAL)
    (recipe,) = read_file(path)
    assert (recipe.door_id, recipe.width, recipe.height, recipe.thickness) == ("narrow", 0.19, 2.5, 0.05)
    first, second = recipe.features
    assert first.force_displacement[0] == pytest.approx((0.0001, 0.00001))
    assert first.force_displacement[5] == pytest.approx((-0.0003, -0.00003))
    assert second.force_displacement is None
    # Everything else is what the thesis milled with: the shipped door of the same size.
    shipped = load_recipe("thesis_190_0deg").to_document()
    mine = recipe.to_document()
    ignored = ("force_displacement_mm", "cutting")
    for ours, theirs in zip(mine["features"], shipped["features"], strict=True):
        assert {k: v for k, v in ours.items() if k not in ignored} == {
            k: v for k, v in theirs.items() if k not in ignored
        }
    assert mine["features"][0]["cutting"] == {"spindle_speed_rpm": 3200.0, "feed_mm_s": 50.0}
    assert recipe.program is Program.PATH_20


@pytest.mark.parametrize(("row", "program"), [("path_20", Program.PATH_20), ("general", Program.GENERAL)])
def test_thesis_table_may_name_the_program(row, program):
    recipe = parse_thesis_text(f"Robot Program\t{row}\n{MINIMAL}", "x.txt", "x")
    assert recipe.program is program
    assert parse_thesis_text(format_thesis_text(recipe), "x.txt", "x") == recipe


def test_thesis_table_of_three_hinges_gets_the_general_program():
    three = MINIMAL.replace("Hinges\t2", "Hinges\t3").replace("150\t2350", "150\t1250\t2350")
    assert parse_thesis_text(three, "x.txt", "x").program is Program.GENERAL


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "cp1252"])
@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_thesis_table_as_excel_saves_it(tmp_path, encoding, ending):
    path = tmp_path / "door.txt"
    text = "Door ID\tdoor_7\t\t\nAuthor\tJørgen\n\t\t\n" + MINIMAL.replace("Door Width", " door  WIDTH :")
    path.write_bytes(text.replace("\n", ending).encode(encoding))
    (recipe,) = read_file(path)
    assert (recipe.door_id, recipe.author, recipe.width) == ("door_7", "Jørgen", 0.19)


def test_thesis_table_of_a_shipped_door_holds_table_4_8():
    text = format_thesis_text(load_recipe("thesis_1350_2deg"))
    assert "Milling Force Left Line\t-209\t29\t12\t-5\t-43\t3\n" in text
    assert "Hinge Position\t150\t2350\n" in text
    assert "Placement Rotation\t2\n" in text


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        (("Door Width\t190\n", ""), e.BadTable, "the row 'Door Width' is missing"),
        (("Door Width\t190", "Door Width\twide"), e.BadTable, "'Door Width': found 'wide'"),
        (("Door Width\t190", "Door Width"), e.BadTable, "found 0 cells"),
        (("Door Width\t190", "Door Width\t190\t5"), e.BadTable, "found 2 cells"),
        (("Door Width\t190", "Door Width\t19"), e.OutOfRange, "width_mm: found 19 mm"),
        (("Door Width\t190", "Door Width\t190\nDoor Width\t190"), e.BadTable, "is there twice"),
        (
            ("Door Width\t190", "Door Width\t190\nDoor Color\tred"),
            e.BadTable,
            "row 2: found the label 'Door Color'",
        ),
        (("Hinges\t2", "Hinges\t3"), e.BadTable, "found 2 positions for 3 hinges"),
        (("150\t2350", "150\t200"), e.FeaturesMeet, "features.1"),
        (("Displacement 1 Z", "Displacement 3 Z"), e.BadTable, "Force Displacement"),
        (("0,1\t", ""), e.BadTable, "must have a cell for each point"),
        (("Feed-Rate\t50", "Feed-Rate\tinf"), e.BadTable, "'Feed-Rate': found 'inf'"),
        (("Feed-Rate\t50", "Feed-Rate\t500"), e.RecipeError, "feed_mm_s"),
        (("Feed-Rate\t50\n", ""), e.MissingField, "feed_mm_s"),
        (("Feed-Rate\t50", "Feed-Rate\t50\nHinge Geometry\t1\t2"), e.BadTable, "found 2 cells"),
    ],
)
def test_wrong_thesis_tables(change, error, message):
    assert change[0] in MINIMAL
    if "500" in change[1]:
        change = (change[0], change[1] + "\nTool Max Chip Load\t0.635")
        extra = "\nTool Diameter\t19\nTool Flutes\t2\nTool Cutting Length\t60\nTool Max Speed\t18000"
        change = (change[0], change[1] + extra)
    with pytest.raises(error, match=message):
        parse_thesis_text(MINIMAL.replace(*change, 1), "x.txt", "x")


@pytest.mark.parametrize(
    "change", [{"side": "rear"}, {"id": "h"}, {"height_from": "top"}, {"kind": "hinge_leaf"}]
)
def test_what_the_thesis_table_cannot_hold_is_refused(tmp_path, document, change):
    feature = {**document["features"][0], "id": "hinge_1", **change}
    if feature["kind"] == "hinge_leaf":
        feature["corner_radius_mm"] = 8
    recipe = Recipe.from_document({**document, "features": [feature]})
    path = tmp_path / "x.txt"
    with pytest.raises(e.NotExpressible, match="no place"):
        write_file(path, [recipe])
    with pytest.raises(e.NotExpressible, match="found 2 doors"):
        write_file(path, [recipe, recipe])
    assert not path.exists()


@pytest.mark.parametrize("name", ["x.doc", "x", "x.CSVX", ".csv"])
def test_unknown_endings(tmp_path, name, recipe):
    for call in (lambda p: read_file(p), lambda p: write_file(p, [recipe])):
        with pytest.raises(e.UnknownFileType, match=r"allowed is one of \.xlsx, \.csv"):
            call(tmp_path / name)


@pytest.mark.parametrize("ending", ["xlsx", "csv", "txt", "yaml", "json"])
def test_absent_file_and_absent_folder(tmp_path, ending):
    with pytest.raises(e.UnreadableFile):
        read_file(tmp_path / f"none.{ending}")
    with pytest.raises(e.UnreadableFile, match="cannot be written"):
        write_file(tmp_path / "none" / f"x.{ending}", [load_recipe("thesis_190_0deg")])


@pytest.mark.parametrize("ending", ["xlsx", "csv", "txt", "yaml", "json"])
def test_a_full_disk_leaves_the_file_that_was_there(tmp_path, ending):
    path = tmp_path / f"x.{ending}"
    path.write_bytes(b"what somebody has")
    with room_for(100), pytest.raises(e.UnreadableFile, match="cannot be written"):
        write_file(path, [load_recipe("thesis_190_0deg")])
    assert path.read_bytes() == b"what somebody has"
    assert list(tmp_path.iterdir()) == [path]


def test_endings_in_capitals(tmp_path, recipe):
    write_file(tmp_path / "X.XLSX", [recipe])
    assert read_file(tmp_path / "X.XLSX") == [recipe]


@pytest.mark.parametrize(
    ("text", "error", "message"),
    [
        ('{"a": 1,}', e.UnreadableFile, "line 1, column"),
        ('{"a": 1, "a": 2}', e.DuplicateField, "given twice"),
        ("[" * 100000, e.UnreadableFile, "nested too deeply"),
        ("[]", None, ""),
        ("NaN", e.WrongType, "x.json"),
        ('[{"schema": "doormill/recipe/1"}, 5]', e.MissingField, "document 1"),
    ],
)
def test_json_files(tmp_path, text, error, message):
    path = tmp_path / "x.json"
    path.write_text(text)
    if error is None:
        assert read_file(path) == []
        return
    with pytest.raises(error, match=message):
        read_file(path)


def test_one_door_twice_in_a_file(tmp_path, recipe):
    path = tmp_path / "x.json"
    path.write_text(json.dumps([recipe.to_document()] * 2))
    with pytest.raises(e.DuplicateName, match="is there twice"):
        read_file(path)


@pytest.mark.parametrize("content", [b"\x80\x81\xfe\x00", b"door_id;h\xf6he\n1;2\n", bytes(range(128, 256))])
def test_a_csv_that_is_no_text_says_so(tmp_path, content):
    path = tmp_path / "doors.csv"
    path.write_bytes(content)
    with pytest.raises(
        e.UnreadableFile, match=r"doors\.csv: (line 1, column \d+: is no UTF-8 text|not a text file)"
    ):
        read_file(path)


def test_an_empty_csv_says_so(tmp_path):
    for text in ("", "\n\n", "\ufeff"):
        (tmp_path / "doors.csv").write_text(text, encoding="utf-8")
        with pytest.raises(e.BadTable, match=r"doors\.csv: the file is empty"):
            read_file(tmp_path / "doors.csv")


@pytest.mark.timeout(60)
@pytest.mark.parametrize("ending", ["csv", "txt", "yaml", "json"])
def test_a_pipe_is_no_recipe_file(tmp_path, ending):
    path = tmp_path / f"doors.{ending}"
    os.mkfifo(path)
    with pytest.raises(
        e.UnreadableFile, match="cannot be read, a pipe, a device or a socket, not a regular file"
    ):
        read_file(path)
