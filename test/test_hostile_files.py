"""Whatever a file holds, it is read or refused in one sentence with a code, within bounds, and nothing is written."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import pytest
from openpyxl import load_workbook

from doormill_ros.errors import LONGEST, DoormillError
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.exchange.files import read_file
from doormill_ros.recipes.exchange.xlsx_file import format_xlsx
from support.hostile.campaign import judge, usable
from support.hostile.mutations import ENTITIES, LAUGHS
from support.hostile.readers import subjects

RUNS = 12


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("good")


def test_bad_files_are_read_or_refused(good: Path) -> None:
    faults, read, refused = [], 0, 0
    for subject in subjects(good / "inputs"):
        assert not usable(subject), subject.name
        outcome = judge(subject, range(RUNS))
        assert outcome.answers.total() == RUNS, subject.name
        read, refused = read + outcome.answers["read"], refused + outcome.answers["refused"]
        faults += outcome.faults
    assert faults == []
    assert read > 50
    assert refused > 200


def workbook(change: object = None) -> bytes:
    """A door as a workbook, changed by hand."""
    book = load_workbook(io.BytesIO(format_xlsx([load_recipe("standard_door")])))
    if callable(change):
        change(book)
    stream = io.BytesIO()
    book.save(stream)
    return stream.getvalue()


def packed(content: bytes, name: str, text: bytes) -> bytes:
    """A workbook with one of its parts replaced."""
    stream = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(content)) as old,
        zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as new,
    ):
        for item in old.namelist():
            new.writestr(item, text if item == name else old.read(item))
    return stream.getvalue()


def cell(sheet: str, column: str, value: object) -> object:
    """Puts a value into the first row below the header."""

    def change(book: object) -> None:
        rows = book[sheet]  # type: ignore[index]  # openpyxl has no types
        place = next(c.column for c in rows[1] if c.value == column)
        rows.cell(2, place).value = value

    return change


def merged(book: object) -> None:
    book["doors"].merge_cells("B2:D2")  # type: ignore[index]  # openpyxl has no types


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (workbook(cell("doors", "height_mm", "2040,5 mm")), "height_mm"),
        (workbook(cell("doors", "height_mm", '80 1/4"')), "height_mm"),
        (workbook(cell("doors", "height_mm", "=1000+1040")), "height_mm"),
        (workbook(cell("doors", "height_mm", "#REF!")), "height_mm"),
        (workbook(merged), "doors"),
        (packed(workbook(), "xl/workbook.xml", ENTITIES.encode()), "door.xlsx"),
        (packed(workbook(), "xl/worksheets/sheet1.xml", ENTITIES.encode()), "door.xlsx"),
        (packed(workbook(), "xl/worksheets/sheet1.xml", bytes(300_000_000)), "200000000"),
        (b"PK\x03\x04", "door.xlsx"),
    ],
    ids=[
        "comma and unit",
        "inches",
        "formula",
        "error value",
        "merged",
        "entities in the book",
        "entities in a sheet",
        "bomb",
        "no archive",
    ],
)
def test_workbooks_nobody_means(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "door.xlsx"
    path.write_bytes(content)
    with pytest.raises(DoormillError, match=says) as refused:
        read_file(path)
    assert "door.xlsx" in str(refused.value)
    assert len(str(refused.value)) <= LONGEST


def test_references_that_multiply_are_no_recipe(tmp_path: Path) -> None:
    path = tmp_path / "door.yaml"
    path.write_text(LAUGHS)
    with pytest.raises(DoormillError):
        load_recipe(path)


def test_a_sentence_is_one_line_of_bounded_length() -> None:
    text = str(DoormillError("first\n\tline \x1b[31m" + "9" * 5000 + "; do that"))
    assert text.startswith("first line [31m9")
    assert text.endswith("9; do that")
    assert len(text) == LONGEST
    assert str(DoormillError("door  å: 3 µm")) == "door  å: 3 µm"
