"""Texts of the pendant: one table, three languages."""

from __future__ import annotations

import re

import pytest

from doormill_ros.resources import resource
from doormill_ros.simulation.controller.configuration.installed import OWN_MODULES
from doormill_ros.simulation.controller.rapid.parser import parse_module

#: Characters: of an event's title, which is the shortest of all places; a line of a message box holds 55, a string 80.
TITLE = 46
HEADER, BUTTON, ENTRY_LINE = 40, 15, 40
LANGUAGES = ("English", "German", "Norwegian")
MODULE = parse_module(resource("rapid/DoorText.mod").read_text(), "DoorText.mod")
DATA = {node.name: node for node in MODULE.data}
NUMBERS = {name: int(node.initial.value) for name, node in DATA.items() if name.startswith("TXT_")}
TABLE = [[text.value for text in row.items] for row in DATA["TABLE"].initial.items]


def test_every_text_has_a_number_and_every_number_a_text():
    assert sorted(NUMBERS.values()) == list(range(1, len(TABLE) + 1))
    assert all(len(row) == len(LANGUAGES) for row in TABLE)
    assert DATA["TEXTS"].initial.value == len(TABLE)


@pytest.mark.parametrize("name", NUMBERS)
def test_a_text_is_whole_in_every_language(name):
    row = TABLE[NUMBERS[name] - 1]
    for language, text in zip(LANGUAGES, row, strict=True):
        assert text.strip() == text != "", language
        assert text.isascii(), language
        assert len(text) <= TITLE, language
    # Numbers, and how a sentence ends, are the same in all of them.
    assert len({tuple(re.findall(r"\d+|%\w?", text)) for text in row}) == 1
    assert len({text[-1] if text[-1] in ".?!:" else "" for text in row}) == 1
    if name != "TXT_OK":
        assert len(set(row)) == len(row), "a language was copied"


@pytest.mark.parametrize("name", ["TXT_RETRACT", "TXT_JOG", "TXT_OK", "TXT_HEADER"])
def test_buttons_and_the_header_fit_into_their_places(name):
    allowed = HEADER if name == "TXT_HEADER" else BUTTON
    assert max(map(len, TABLE[NUMBERS[name] - 1])) <= allowed


def test_the_lines_of_a_question_for_a_number_leave_room_for_its_keys():
    calls = re.findall(r"AskNumber\((TXT_\w+),(TXT_\w+)\)", resource("rapid/DoorTool.mod").read_text())
    assert calls
    assert (
        max(len(text) for call in calls for name in call for text in TABLE[NUMBERS[name] - 1]) <= ENTRY_LINE
    )


def test_every_text_is_used():
    others = "".join(resource(name).read_text() for name in OWN_MODULES if not name.endswith("DoorText.mod"))
    others += (
        resource("rapid/DoorText.mod").read_text().split("ENDPROC", 1)[0].split("FUNC string Text", 1)[1]
    )
    used = set(re.findall(r"TXT_\w+", others)) | {"TXT_HEADER"}
    assert set(NUMBERS) == used


@pytest.mark.parametrize(("language", "column"), [(1, 0), (2, 1), (3, 2), (0, 0), (4, 0)])
def test_the_pendant_speaks_the_language_of_the_cell_and_the_pc_reads_english(controller, language, column):
    robot = controller()
    robot.program.write("language", str(language))
    robot.run()  # there is no target file
    missing = TABLE[NUMBERS["TXT_MISSING"] - 1]
    assert missing[column] in robot.pendant_lines
    header = TABLE[NUMBERS["TXT_HEADER"] - 1][column]
    assert [(e.title, e.text) for e in robot.event_log if e.number == 80001] == [
        (header, f"{missing[column]} Hei2.txt")
    ]
    assert (robot.home / "Hei2.err").read_text().splitlines()[1:] == [missing[0], "Hei2.txt"]


@pytest.mark.parametrize("language", [1, 2, 3])
def test_a_question_is_asked_in_the_language_of_the_cell(controller, language):
    robot = controller(start=[0.3, -0.7, 0.5, 0.0, 0.2, 0.0])  # not at home
    robot.program.write("language", str(language))
    dialog = robot.run_to_question()
    names = ("TXT_HEADER", "TXT_NOT_HOME", "TXT_BY_HAND", "TXT_OK")
    wanted = [TABLE[NUMBERS[name] - 1][language - 1] for name in names]
    assert [dialog.header, *dialog.lines, dialog.buttons[0][0]] == wanted
