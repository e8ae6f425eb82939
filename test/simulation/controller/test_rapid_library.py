"""Predefined routines: strings, files, numbers, as documented and at their edges."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from doormill_ros.simulation.controller.rapid.errors import RapidRuntimeError
from doormill_ros.simulation.controller.rapid.literals import parse_literal
from doormill_ros.simulation.controller.rapid.types import (
    NUM,
    ROBTARGET,
    STRING,
    ArrayType,
    float32,
    format_number,
    format_value,
)


def number(say, expression: str) -> float:
    return float(say(f"TPWrite ValToStr({expression});")[-1])


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ('StrLen("")', 0),
        ('StrFind("a;b;c",1,";")', 2),
        ('StrFind("a;b;c",3,";")', 4),
        ('StrFind("a;b;c",5,";")', 6),  # not found: length + 1, not 0
        ('StrFind("abcd",1,"dc")', 3),  # a set of characters, not a text
        ('StrFind("aab",1,"a"\\NotInSet)', 3),
        ('StrMatch("abcabc",2,"abc")', 4),
        ('StrMatch("abcabc",5,"abc")', 7),
        ('StrToByte("A"\\Char)', 65),
        ('StrToByte("ff"\\Hex)', 255),
        ("Round(2.5)", 3),
        ("Round(-2.5)", -3),
        ("Round(1.2345\\Dec:=2)", 1.23),
        ("Trunc(-2.7)", -2),
        ("-7 DIV 2", -3),
        ("-7 MOD 2", -1),
        ("Abs(-3)", 3),
        ("Sin(30)", 0.5),
        ("ATan2(1,-1)", 135),
        ("Pow(2,10)", 1024),
        ("BitXOr(12,10)", 6),
        ("Distance([0,3,0],[4,0,0])", 5),
        ("DotProd([1,2,3],[4,5,6])", 32),
    ],
)
def test_functions(say, expression, value):
    assert number(say, expression) == pytest.approx(value, abs=1e-6)


@pytest.mark.parametrize(
    "expression",
    [
        'StrFind("abc",0,"a")',
        'StrFind("abc",4,"a")',
        'StrFind("",1,"a")',
        'StrLen(StrPart("abc",1,4))',
        'StrLen(StrPart("abc",4,0))',
        'StrLen(StrPart("abc",2,-1))',
        'StrLen(StrPart("abc",1.5,1))',
    ],
)
def test_positions_outside_a_string_stop_the_program_past_every_handler(load, expression):
    program = load("VAR num x;", f"x:={expression};\nERROR\nTRYNEXT;")
    with pytest.raises(RapidRuntimeError, match="outside the string"):
        program.run()


def test_parts_of_strings(say):
    assert say(
        'TPWrite StrPart("abcdef",2,3); TPWrite "<"+StrPart("abc",2,0)+">"; TPWrite StrMap("a.b",".",",");'
    ) == [
        "bcd",
        "<>",
        "a,b",
    ]


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("1.5", "num", "1.5"),
        ("-1E3", "num", "-1000"),
        (" 2 ", "num", "2"),
        ("1,5", "num", None),
        ("", "num", None),
        ("1.5;", "num", None),
        ("1E39", "num", None),
        ("TRUE", "bool", "TRUE"),
        ("1", "bool", None),
        ("[1,2,3]", "pos", "[1,2,3]"),
        ("[1,2]", "pos", None),
        ("[1, 2,3]", "pos", None),
        ("[1,2,3,4,5,6]", "robjoint", "[1,2,3,4,5,6]"),
        ("[1,2,3,4,5]", "robjoint", None),
        ("[[1,2,3,4,5,6],[0,0,0,0,0,9E9]]", "jointtarget", "[[1,2,3,4,5,6],[0,0,0,0,0,9E+09]]"),
        ("[[1,2,3,4,5,6],[0,0]]", "jointtarget", None),
        ('""text""', "string", '"text"'),
        ("text", "string", None),
        ('[""L"",3.5,TRUE]', "row", '["L",3.5,TRUE]'),
    ],
)
def test_str_to_val_reads_literals_and_leaves_the_data_alone_otherwise(say, text, kind, value):
    record = "RECORD row string k; num n; bool b; ENDRECORD"
    lines = say(
        f'before:=ValToStr(x); TPWrite ValToStr(StrToVal("{text}",x)); TPWrite before; TPWrite ValToStr(x);',
        f"{record} VAR {kind} x; VAR string before;",
    )
    assert lines[0] == ("TRUE" if value is not None else "FALSE")
    assert lines[2] == (value if value is not None else lines[1])


def test_str_to_val_keeps_what_was_there(say):
    assert say('x:=7; IF NOT StrToVal("1,5",x) TPWrite ValToStr(x);', "VAR num x;") == ["7"]


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_nums_survive_being_written_with_nine_digits(value):
    assert parse_literal(f"{value:.9g}".replace("e+", "E").replace("e", "E"), NUM) == value


@given(st.floats(min_value=-1e30, max_value=1e30, allow_nan=False).map(float32))
def test_val_to_str_gives_six_digits_that_read_back(value):
    text = format_number(value)
    assert parse_literal(text, NUM) == pytest.approx(value, rel=5e-6)
    assert len(text.strip("-").split("E")[0].replace(".", "").lstrip("0")) <= 6


@given(st.text(st.characters(min_codepoint=32, max_codepoint=255), max_size=40))
def test_strings_survive_being_written_as_literals(text):
    assert parse_literal(format_value(text), STRING) == text


@given(st.text(max_size=60))
def test_no_text_crashes_the_reading_of_literals(text):
    """A text that is no literal is no error either."""
    for kind in (NUM, STRING, ROBTARGET, ArrayType(NUM, (2, 2))):
        parse_literal(text, kind)


# Files

READ = """
    Open "HOME:" \\File:="f.txt", f \\Read;
    text:=ReadStr(f);
    WHILE text<>EOF DO
        TPWrite text;
        text:=ReadStr(f);
    ENDWHILE
    Close f;
"""
DATA = "VAR iodev f; VAR string text;"


def test_lines_are_read_without_their_ends(say, machine):
    (machine.home / "f.txt").write_bytes(b"a\n\nb\r\nlast")
    assert say(READ, DATA) == ["a", "", "b\r", "last"]


def test_more_than_80_characters_come_in_two_calls(say, machine):
    (machine.home / "f.txt").write_bytes(b"x" * 79 + b"\n" + b"y" * 81 + b"\nz\n")
    assert say(READ, DATA) == ["x" * 79, "y" * 80, "y", "z"]


def test_a_line_of_exactly_80_may_leave_its_end_for_the_next_call(say, machine):
    """The harsher of two readings; it is why the writer stays at 79."""
    (machine.home / "f.txt").write_bytes(b"x" * 80 + b"\nz\n")
    assert say(READ, DATA) == ["x" * 80, "", "z"]


def test_switches_of_read_str(say, machine):
    (machine.home / "f.txt").write_bytes(b"\n\na,b\r\nc\n")
    body = """Open "HOME:f.txt", f \\Read;
    TPWrite ReadStr(f\\DiscardHeaders\\Delim:=",");
    TPWrite ReadStr(f\\RemoveCR); TPWrite ReadStr(f\\Line:=3); TPWrite ReadStr(f\\Line:=9); Close f;"""
    assert say(body, DATA) == ["a", "b", "a,b\r", "EOF"]


def test_what_is_written_can_be_read(say, machine):
    body = 'Open "HOME:new.txt", f \\Write; Write f, "one"; Write f, "tw"\\NoNewLine; Write f, "o"; Close f;'
    say(body, DATA)
    assert (machine.home / "new.txt").read_bytes() == b"one\ntwo\n"


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ('Open "HOME:none.txt", f \\Read;', "ERR_FILEOPEN"),
        ('Open "HOME:../f.txt", f \\Read;', "ERR_FILEACC"),
        ('Open "HOME:/../../f.txt", f \\Read;', "ERR_FILEACC"),
        ('Open "C:f.txt", f \\Read;', "ERR_FILEACC"),
        ('Open "HOME:", f \\Read;', "ERR_FILEACC"),
        ('Open "HOME:f.txt", f \\Read; Open "HOME:f.txt", f \\Read;', "ERR_FILEOPEN.*open already"),
        ("text:=ReadStr(f);", "ERR_FILEACC.*not open"),
        ("Close f;", "ERR_FILEACC.*not open"),
        ('Open "HOME:f.txt", f \\Write; text:=ReadStr(f);', "ERR_FILEACC.*open for writing"),
        ('RemoveFile "HOME:none.txt";', "ERR_FILEACC"),
    ],
)
def test_files_that_cannot_be_used_raise_what_a_handler_can_take(load, machine, body, words):
    (machine.home / "f.txt").write_text("a\n")
    with pytest.raises(RapidRuntimeError, match=words):
        load(DATA, body).run()
    program = load(DATA, body + "\nERROR\nTRYNEXT;")
    program.run()


def test_files_are_closed_when_the_program_ends(load, machine):
    (machine.home / "f.txt").write_text("a\n")
    program = load(DATA, 'Open "HOME:f.txt", f \\Read; EXIT;')
    program.run()
    assert program.context.devices == []


# Targets


def test_offs_and_rel_tool(say):
    declare = "CONST robtarget t:=[[100,200,300],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];"
    lines = say(
        "p:=Offs(t,1,2,3); TPWrite ValToStr(p.trans); p:=RelTool(t,1,2,3); TPWrite ValToStr(p.trans);",
        declare + "VAR robtarget p;",
    )
    # Half a turn about y: the tool's x and z point backwards.
    assert lines == ["[101,202,303]", "[99,202,297]"]


def test_quaternions_multiply_as_rotations_do(say):
    half = float(np.float32(np.sqrt(0.5)))
    lines = say(
        "o:=a*b; TPWrite ValToStr(o);",
        f"CONST orient a:=[{half},{half},0,0]; CONST orient b:=[0,0,0,1]; VAR orient o;",
    )
    assert lines == ["[0,0,-0.707107,0.707107]"]
