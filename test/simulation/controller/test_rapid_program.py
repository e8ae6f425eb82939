"""What lives on between runs, what the event log keeps, and what is asked about controller and robot."""

from __future__ import annotations

import numpy as np
import pytest

from doormill_ros.simulation.controller.rapid.errors import RapidRuntimeError


def test_a_reload_gives_the_values_of_the_text_and_a_run_keeps_them(load, machine):
    program = load("PERS num p:=1; VAR num v:=1;", "p:=p+1; v:=v+1;")
    program.run()
    program.run(reset=False)
    assert (program.read("p"), program.read("v")) == (3.0, 3.0)
    program.reload()
    assert (program.read("p"), program.read("v")) == (1.0, 1.0)


def test_an_error_that_is_taken_leaves_a_warning_unless_it_is_skipped(load, machine):
    load("VAR num x;", "x:=1/0;\nx:=2/0;\nERROR IF x<0 THEN TRYNEXT; ENDIF SkipWarn; TRYNEXT;").run()
    assert machine.entries == []
    load("VAR num x;", "\nx:=1/0;\nERROR TRYNEXT;").run()
    assert machine.entries == [("warning", "error taken", "test.mod, line 5: ERR_DIVZERO: division by zero")]


def test_an_error_of_the_programs_own_leaves_none(load, machine):
    load("", "RAISE 7; ERROR TRYNEXT;").run()
    assert machine.entries == []


def test_files_are_copied_and_renamed_but_none_is_replaced(say, load, machine):
    (machine.home / "a.txt").write_text("A")
    body = 'CopyFile "HOME:a.txt","HOME:b.txt"; RenameFile "HOME:a.txt","HOME:c.txt";'
    assert say(body + 'TPWrite ValToStr(IsFile("HOME:a.txt"));') == ["FALSE"]
    assert {p.name: p.read_text() for p in machine.home.iterdir()} == {"b.txt": "A", "c.txt": "A"}
    for name in ("CopyFile", "RenameFile"):
        with pytest.raises(RapidRuntimeError, match="ERR_FILEEXIST"):
            load("", f'{name} "HOME:b.txt","HOME:c.txt";').run()
        with pytest.raises(RapidRuntimeError, match=r"ERR_FILEACC.*no such file"):
            load("", f'{name} "HOME:none.txt","HOME:d.txt";').run()


def test_modes(say):
    assert say("TPWrite ValToStr(OpMode()=OP_AUTO)+ValToStr(RunMode()=RUN_CONT_CYCLE);") == ["TRUETRUE"]


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("PathAccLim TRUE\\AccMax:=1,TRUE;", "DecelMax is missing"),
        ("PathAccLim TRUE\\AccMax:=0.01,FALSE;", "AccMax is missing or below"),
        ("MotionSup;", "one of"),
        ("MotionSup\\On\\TuneValue:=400;", "TuneValue 400"),
        ("AccSet 0,100;", "AccSet 0"),
    ],
)
def test_motion_settings_out_of_range(load, body, words):
    with pytest.raises(RapidRuntimeError, match=words):
        load("", body).run()


def test_joints_and_targets_follow_from_each_other(tmp_path, controller):
    module = tmp_path / "calc.mod"
    module.write_text("""MODULE calc
PERS tooldata tMill:=[TRUE,[[0,0,250],[1,0,0,0]],[20,[0,0,120],[1,0,0,0],0,0,0]];
VAR jointtarget j{2}; VAR robtarget p; VAR errnum e; VAR jointtarget far;
PROC main()
    j{1}:=CJointT(); p:=CalcRobT(j{1},tMill); j{2}:=CalcJointT(p,tMill);
    p.trans.x:=9000; far:=CalcJointT(p,tMill\\ErrorNumber:=e);
    MoveAbsJ j{2},v100,fine,tMill;
    far:=CalcJointT(p,tMill);
ERROR
    TPWrite ValToStr(ERRNO=ERR_OUTSIDE_REACH)+ValToStr(e=ERR_OUTSIDE_REACH); TRYNEXT;
ENDPROC
ENDMODULE
""")
    robot = controller(modules=[module], expected_door=None)
    robot.run()
    assert robot.pendant_lines == ["TRUETRUE"]
    first, second = robot.program.read("j")
    np.testing.assert_allclose(second[0], first[0], atol=1e-3)
    np.testing.assert_allclose(first[0], [0.0, -40.0, 30.0, 0.0, 10.0, 0.0], atol=1e-6)
