"""Nothing that is read from outside can crash anything: every failure is one of the stated errors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from doormill_ros.abb.errors import AbbError
from doormill_ros.abb.target_file.target_file import read_target_file, render_target_file
from doormill_ros.resources import resource
from doormill_ros.simulation.controller.rapid.errors import (
    RapidProgramError,
    RapidStoppedError,
    RapidSyntaxError,
    RapidUnsupportedError,
)
from doormill_ros.simulation.controller.rapid.parser import parse_module
from doormill_ros.simulation.controller.rapid.program import RapidProgram

FUZZ = settings(max_examples=250, deadline=None, suppress_health_check=list(HealthCheck))
MODULES = ("rapid/DoorMill.mod", "rapid/DoorFile.mod", "rapid/DoorCell.mod")
LOADING = (RapidSyntaxError, RapidUnsupportedError, RapidProgramError)

WORDS = """
    MODULE ENDMODULE PROC ENDPROC FUNC ENDFUNC RECORD ENDRECORD VAR PERS CONST LOCAL num string bool pos robtarget
    IF THEN ELSEIF ELSE ENDIF FOR FROM TO STEP DO ENDFOR WHILE ENDWHILE TEST CASE DEFAULT ENDTEST RETURN RAISE
    RETRY TRYNEXT EXIT ERROR AND OR NOT DIV MOD TRUE FALSE a b c main ERRNO ( ) [ ] { } , ; : := = <> < > + - * /
    \\ . ? 1 2.5 1E9 "text" "" ! % | tpwrite strpart strfind movel stropen x.y v100 fine tool0
"""
WORDS = WORDS.split()


def failure(call: Callable[[], object]) -> AbbError | None:
    """The stated error a call ends with; any other one is the crash that is looked for."""
    try:
        call()
    except AbbError as error:
        return error
    return None


@FUZZ
@given(data=st.binary(max_size=300))
def test_any_bytes_are_read_or_named(data):
    error = failure(lambda: read_target_file(data))
    assert error is None or (type(error) is not AbbError and "allowed" in error.message)


@FUZZ
@given(data=st.data())
def test_mutated_target_files_are_read_or_named(data, good_file):
    mutated = bytearray(good_file)
    for _ in range(data.draw(st.integers(1, 6))):
        at = data.draw(st.integers(0, len(mutated) - 1))
        action = data.draw(st.sampled_from(["set", "insert", "delete", "copy"]))
        piece = data.draw(
            st.sampled_from([b";", b"\n", b"#", b"-", b"9", b"[", b'"', b"#sum [", b"\xff", b"1e9"])
        )
        if action == "set":
            mutated[at : at + len(piece)] = piece
        elif action == "insert":
            mutated[at:at] = piece
        elif action == "delete":
            del mutated[at : at + data.draw(st.integers(1, 40))]
        else:
            mutated[at:at] = mutated[: data.draw(st.integers(0, 200))]
        if not mutated:
            break
    error = failure(lambda: read_target_file(bytes(mutated)))
    assert error is None or (type(error) is not AbbError and "allowed" in error.message)


@pytest.fixture(scope="module")
def good_file(door) -> bytes:
    return render_target_file(door("thesis_190_0deg"), "run-1")


@FUZZ
@given(text=st.text(max_size=200))
def test_any_text_is_parsed_or_named(text):
    with pytest.raises((RapidSyntaxError, RapidUnsupportedError)) as caught:
        parse_module(text, "fuzz.mod")
    assert caught.value.message.startswith("fuzz.mod")


@FUZZ
@given(words=st.lists(st.sampled_from(WORDS), max_size=60))
def test_any_words_of_the_language_are_parsed_or_named(words):
    text = "MODULE m\nPROC main()\n" + " ".join(words) + "\nENDPROC\nENDMODULE\n"
    error = failure(lambda: parse_module(text, "fuzz.mod"))
    assert error is None or (isinstance(error, LOADING) and error.message.startswith("fuzz.mod"))


@settings(FUZZ, max_examples=80)
@given(data=st.data())
def test_mutated_modules_are_loaded_or_named(data, tmp_path_factory, fuzz_machine):
    """Words of our own modules exchanged, lost and doubled: loading ends or names file and line."""
    texts = [resource(name).read_text() for name in MODULES]
    which = data.draw(st.integers(0, len(texts) - 1))
    words = texts[which].split(" ")
    for _ in range(data.draw(st.integers(1, 4))):
        i, j = (data.draw(st.integers(0, len(words) - 1)) for _ in range(2))
        action = data.draw(st.sampled_from(["lose", "double", "exchange", "replace"]))
        if action == "lose":
            del words[i]
        elif action == "double":
            words.insert(j, words[i])
        elif action == "exchange":
            words[i], words[j] = words[j], words[i]
        else:
            words[i] = data.draw(st.sampled_from(WORDS))
    texts[which] = " ".join(words)
    error = failure(
        lambda: RapidProgram(
            [parse_module(t, Path(n).name) for t, n in zip(texts, MODULES, strict=True)], fuzz_machine
        )
    )
    assert error is None or (
        isinstance(error, LOADING) and (", line " in error.message or "nested" in error.message)
    )


@FUZZ
@given(
    body=st.lists(
        st.sampled_from(
            [
                "a:=a+1;",
                "a:=a/b;",
                "b:=b*1E20;",
                "l{a}:=b;",
                "a:=l{b};",
                "s:=s+s;",
                's:=s+"xxxxxxxxxx";',
                "a:=StrFind(s,a,s);",
                "s:=StrPart(s,a,b);",
                "ok:=StrToVal(s,a);",
                "ok:=StrToVal(s,p);",
                "s:=ValToStr(p);",
                "s:=NumToStr(b,a);",
                "a:=StrToByte(s\\Char);",
                "RAISE a;",
                "p:=p*p;",
                "o:=NOrient(o);",
                "again;",
                "RETURN;",
                "EXIT;",
                "IF a<5 THEN a:=a+1; again; ENDIF",
                "FOR i FROM a TO b DO a:=i; IF i>50 RETURN; ENDFOR",
                'Open "HOME:"\\File:=s,f\\Read;',
                "Close f;",
                "s:=ReadStr(f);",
                "SetAO aoC,b;",
                "SetDO doA,a;",
                "WaitTime a;",
                "TEST a CASE 1: b:=1; CASE 2,3: b:=0; DEFAULT: a:=3; ENDTEST",
            ]
        ),
        min_size=1,
        max_size=12,
    ),
    handler=st.sampled_from(
        ["", "ERROR TRYNEXT;", "ERROR RAISE;", "ERROR RETRY;", "ERROR a:=1; b:=1; RETRY;", "ERROR RETURN;"]
    ),
)
def test_running_ends_or_is_named(body, handler, fuzz_machine):
    declarations = (
        "VAR num a; VAR num b; VAR num l{3}; VAR string s; VAR pos p; VAR orient o; VAR bool ok; VAR iodev f;"
        "VAR num depth;"
    )
    again = "PROC again() depth:=depth+1; IF depth<60 main; ENDPROC"
    text = (
        f"MODULE m\n{declarations}\nPROC main()\n"
        + "\n".join(body)
        + f"\n{handler}\nENDPROC\n{again}\nENDMODULE\n"
    )
    program = RapidProgram([parse_module(text, "fuzz.mod")], fuzz_machine)
    error = failure(program.run)
    assert error is None or "fuzz.mod, line " in error.message or isinstance(error, RapidStoppedError)


@pytest.fixture(scope="module")
def fuzz_machine(tmp_path_factory):
    """A machine that ends what does not end."""

    class Machine:
        home = tmp_path_factory.mktemp("home")
        count = 0

        def signal_kinds(self):
            names = (
                "doPathRequest",
                "doPathReady",
                "doPathFault",
                "doPathBusy",
                "doPathDone",
                "doSpindleOn",
                "doBlowOff",
            )
            kinds = dict.fromkeys((*names, "doA"), "signaldo")
            return (
                kinds
                | {"aoC": "signalao", "aoSpindleSpeed": "signalao"}
                | dict.fromkeys(("diSpindleAtSpeed", "diDoorClamped", "diB"), "signaldi")
            )

        def set_attendant(self, attendant):
            pass

        def statement(self, _file, _line):
            self.count += 1
            if self.count % 20_000 == 0:
                raise RapidStoppedError("too long")

        def read_signal(self, _name):
            return 0.0

        def write_signal(self, name, value):
            pass

        def now(self):
            return 0.0

        def wait(self, condition, _seconds):
            return condition is None

        def wait_in_position(self):
            pass

        def pendant(self, text):
            pass

        def log(self, *entry):
            pass

    return Machine()
