"""Questions on the pendant."""

from __future__ import annotations

import pytest

from doormill_ros.simulation.controller.rapid.errors import RapidRuntimeError, SignalError

DATA = 'VAR num r; VAR errnum f; PERS bool p:=FALSE; VAR string own{2}:=["Again","Home"];'
LIST = 'VAR listitem l{2}:=[["","oak"],["","pine"]];'


@pytest.fixture
def choose(machine):
    """The operator presses this, at once."""

    def choose_(button: str) -> None:
        machine.pendant_unit.operator = lambda dialog: button

    return choose_


def test_a_message_box_gives_the_button(say, machine, choose):
    choose("No")
    body = (
        'UIMsgBox\\Header:="Door 7","Mill it?"\\MsgLine2:="It is oak."'
        "\\Buttons:=btnYesNo\\Icon:=iconWarning\\Result:=r;"
        "TPWrite ValToStr(r=resNo);"
    )
    assert say(body, DATA) == ["TRUE"]
    (dialog,) = machine.pendant_unit.dialogs
    assert (dialog.header, dialog.lines) == ("Door 7", ("Mill it?", "It is oak."))
    assert [text for text, _ in dialog.buttons] == ["Yes", "No"]
    assert machine.pendant_unit.dialog is None


@pytest.mark.parametrize(
    ("call", "button", "result"),
    [
        ('UIMessageBox(\\Message:="Go on?"\\Buttons:=btnOKCancel)', "Cancel", "5"),
        ('UIMessageBox(\\Header:="H"\\MsgArray:=own\\BtnArray:=own)', "Home", "2"),
        ('UIListView(\\Header:="Wood",l)', "pine", "2"),
        ('UIListView(\\Result:=r\\Header:="Wood",l\\Buttons:=btnOKCancel\\DefaultIndex:=1)', "OK", "1"),
    ],
)
def test_dialogs_that_are_functions(say, choose, call, button, result):
    choose(button)
    assert say(f"TPWrite ValToStr({call});", DATA + LIST) == [result]


@pytest.mark.parametrize(
    ("limits", "typed", "result"),
    [
        ("", "120.25", "120.25"),
        ("", "-3", "-3"),
        ("", "OK", "0"),
        ("\\InitValue:=5", "OK", "5"),
        ("\\InitValue:=5\\MinValue:=1\\MaxValue:=10\\AsInteger", "10", "10"),
    ],
)
def test_a_number_is_what_was_typed_or_stood_there(say, machine, choose, limits, typed, result):
    choose(typed)
    call = f'UINumEntry(\\Header:="H"\\MsgArray:=own{limits})'
    assert say(f"TPWrite ValToStr({call});", DATA) == [result]
    (dialog,) = machine.pendant_unit.dialogs
    assert (dialog.header, dialog.lines, dialog.buttons) == ("H", ("Again", "Home"), (("OK", 1.0),))


@pytest.mark.parametrize(
    ("limits", "typed", "words"),
    [
        ("\\MaxValue:=10", "10.5", "does not take '10.5', allowed are numbers from any to 10"),
        ("\\MinValue:=-1", "-2", "allowed are numbers from -1 to any"),
        ("\\AsInteger", "1.5", "allowed are whole numbers"),
        ("", "Maybe", "does not take 'Maybe'"),
    ],
)
def test_a_number_beyond_the_limits_cannot_be_confirmed(load, choose, limits, typed, words):
    choose(typed)
    with pytest.raises(SignalError, match=words):
        load(DATA, f'r:=UINumEntry(\\Message:="?"{limits});').run()


@pytest.mark.parametrize(("initial", "result"), [("", "0"), ("\\InitValue:=5", "5")])
def test_a_question_for_a_number_that_is_broken_off_gives_what_stood_there(say, initial, result):
    body = f'TPWrite ValToStr(UINumEntry(\\Message:="?"{initial}\\MaxTime:=1\\BreakFlag:=f));'
    assert say(f"{body} TPWrite ValToStr(f=ERR_TP_MAXTIME);", DATA) == [result, "TRUE"]


def test_function_keys(say, machine, choose):
    choose("Skip")
    assert say('TPReadFK r,"Next?",stEmpty,"Mill",stEmpty,"Skip",stEmpty; TPWrite ValToStr(r);', DATA) == [
        "Next?",
        "4",
    ]


@pytest.mark.parametrize(
    ("breaks", "error", "after"),
    [
        ("\\MaxTime:=3", "ERR_TP_MAXTIME", 3.0),
        ("\\MaxTime:=3\\DIBreak:=diB", "ERR_TP_DIBREAK", 1.0),
        ("\\MaxTime:=3\\DIBreak:=diB\\DIPassive", "ERR_TP_DIBREAK", 0.0),
        ("\\MaxTime:=3\\DOBreak:=doA", "ERR_TP_DOBREAK", 2.0),
        ("\\MaxTime:=3\\PersBoolBreak:=p", "ERR_TP_PERSBOOLBREAK", 1.0),
    ],
)
def test_a_question_that_is_broken_off(say, load, machine, breaks, error, after):
    """Without a flag it is an error, with one the program goes on."""
    machine.plan.extend([(1.0, "diB", 1.0), (2.0, "doA", 1.0)])
    trap = "TRAP t p:=TRUE; ENDTRAP"
    order = "CONNECT i WITH t; ISignalDI diB,1,i;"
    box = f'UIMsgBox "?"\\Buttons:=btnYesNo\\Result:=r{breaks}'
    body = f"{order} {box}\\BreakFlag:=f; TPWrite ValToStr(f={error})+ValToStr(r=resUnkwn);"
    assert say(body, DATA + "VAR intnum i;", trap) == ["TRUETRUE"]
    assert machine.time == pytest.approx(after, abs=0.01)
    machine.plan[:] = [(machine.time + 1.0, "diB", 1.0), (machine.time + 2.0, "doA", 1.0)]
    machine.signals.update(diB=0.0, doA=0.0)
    with pytest.raises(RapidRuntimeError, match=error):
        load(DATA + "VAR intnum i;", f"{order} {box};", trap).run()


def test_a_trap_runs_while_a_question_is_open(say, machine, choose):
    machine.plan.append((0.5, "diB", 1.0))
    body = 'CONNECT i WITH t; ISignalDI diB,1,i; UIMsgBox "?"\\MaxTime:=1\\BreakFlag:=f; TPWrite "after";'
    assert say(body, DATA + "VAR intnum i;", 'TRAP t TPWrite "trap"; ENDTRAP') == ["trap", "after"]


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (f'UIMsgBox\\Header:="{"h" * 41}","?";', "ERR_STRTOOLNG: UIMsgBox: header of 41"),
        (f'UIMsgBox "{"l" * 56}";', "ERR_STRTOOLNG: UIMsgBox: line of 56"),
        ('UIMsgBox "?"\\Buttons:=9;', "ERR_UI_BUTTONS"),
        ('UIMsgBox "?"\\Icon:=9;', "ERR_UI_ICON"),
        ('r:=UINumEntry(\\Message:="?"\\MinValue:=2\\MaxValue:=1);', "ERR_UI_MAXMIN"),
        ('r:=UINumEntry(\\Message:="?"\\InitValue:=3\\MaxValue:=2);', "ERR_UI_INITVALUE"),
        ('r:=UINumEntry(\\Message:="?"\\MinValue:=119.5\\MaxValue:=120.5);', "ERR_UI_INITVALUE"),
        ('r:=UINumEntry(\\Message:="?"\\InitValue:=1.5\\AsInteger);', "ERR_UI_NOTINT"),
        (f'r:=UINumEntry(\\Message:="{"l" * 41}");', "ERR_STRTOOLNG: UINumEntry: line of 41"),
        ('UIMsgBox "?"\\Buttons:=btnNone;', "would never end"),
        ('TPReadFK r,"?",stEmpty,stEmpty,stEmpty,stEmpty,stEmpty;', "would never end"),
    ],
)
def test_questions_that_a_pendant_does_not_ask(load, body, words):
    with pytest.raises(RapidRuntimeError, match=words):
        load(DATA, body).run()


def test_an_operator_can_only_press_what_is_there(machine, choose, load):
    choose("Maybe")
    with pytest.raises(SignalError, match=r"no button 'Maybe'.*allowed are Yes, No"):
        load(DATA, 'UIMsgBox "?"\\Buttons:=btnYesNo;').run()
    with pytest.raises(SignalError, match="no dialog is open"):
        machine.pendant_unit.press("Yes")
