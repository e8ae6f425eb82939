"""What RAPID's language does, as far as it differs from what one would expect."""

from __future__ import annotations

import re

import numpy as np
import pytest

from doormill_ros.simulation.controller.rapid.errors import (
    RapidProgramError,
    RapidRuntimeError,
    RapidSyntaxError,
    RapidUnsupportedError,
)
from doormill_ros.simulation.controller.rapid.parser import parse_module


def test_names_and_keywords_ignore_case(say):
    assert say('vaLUE := 2; tpwrite "x"\\num:=VALUE;', "VAR num Value;") == ["x2"]


def test_a_num_is_a_float32(say):
    # 2^24 + 1 and 0.1 as float32 has them.
    assert say(
        'TPWrite ValToStr(16777217-16777216); x:=0.1; TPWrite ValToStr(x=0.1); TPWrite "d"\\Num:=x+x+x-0.3;',
        "VAR num x;",
    ) == [
        "0",
        "TRUE",
        "d"
        + f"{float(np.float32(np.float32(0.1) + np.float32(0.1)) + np.float32(0.1) - np.float32(0.3)):.6g}".replace(
            "e-0", "E-0"
        ),
    ]


def test_integers_are_exact_up_to_2_to_the_24(say):
    assert say("TPWrite ValToStr((250*32748+99) MOD 32749);") == [str((250 * 32748 + 99) % 32749)]


def test_values_print_with_six_digits(say):
    lines = say(
        "TPWrite ValToStr(16777216); TPWrite ValToStr(1234.5678); p:=[1.5,-2,3E-7]; TPWrite ValToStr(p);",
        "VAR pos p;",
    )
    assert lines == ["1.67772E+07", "1234.57", "[1.5,-2,3E-07]"]


def test_records_and_arrays_are_assigned_by_value(say):
    assert say(
        "a:=[[1,2,3],[4,5,6]]; b:=a{1}; a{1}.x:=9; c:=a; c{2}.y:=8; TPWrite ValToStr(b); TPWrite ValToStr(a);",
        "VAR pos a{2}; VAR pos b; VAR pos c{2};",
    ) == ["[1,2,3]", "[[9,2,3],[4,5,6]]"]


def test_parameters_are_values_unless_declared_otherwise(say):
    rest = """
    PROC value(num n) n:=n+1; ENDPROC
    PROC reference(VAR num n) n:=n+1; ENDPROC
    PROC element(INOUT num n) n:=n+10; ENDPROC
    PROC whole(VAR num list{*}) list{1}:=5; ENDPROC
    FUNC num twice(num n \\switch minus) IF Present(minus) RETURN -2*n; RETURN 2*n; ENDFUNC
    FUNC num maybe(\\num n) IF Present(n) RETURN n; RETURN 7; ENDFUNC
    """
    lines = say(
        "value a; TPWrite ValToStr(a); reference a; TPWrite ValToStr(a); element l{2}; whole l; TPWrite ValToStr(l);"
        "TPWrite ValToStr(twice(3)); TPWrite ValToStr(twice(3\\minus)); TPWrite ValToStr(maybe()+maybe(\\n:=1));",
        "VAR num a:=1; VAR num l{3}:=[1,2,3];",
        rest,
    )
    assert lines == ["1", "2", "[5,12,3]", "6", "-6", "8"]


def test_for_without_step_counts_down_when_it_has_to(say):
    assert say("FOR i FROM 1 TO 0 DO TPWrite ValToStr(i); ENDFOR") == ["1", "0"]


def test_for_with_step(say):
    assert say(
        "FOR i FROM 1 TO 0 STEP 1 DO TPWrite ValToStr(i); ENDFOR "
        "FOR i FROM 5 TO 1 STEP -2 DO TPWrite ValToStr(i); ENDFOR"
    ) == ["5", "3", "1"]


def test_test_takes_the_first_case_that_fits(say):
    test = 'TEST i CASE 1,2: TPWrite "a"; CASE 2,3: TPWrite "b"; DEFAULT: TPWrite "c"; ENDTEST'
    body = f"FOR i FROM 1 TO 4 DO {test} ENDFOR"
    assert say(body) == ["a", "a", "b", "c"]


def test_both_sides_of_and_are_evaluated(load):
    program = load("VAR string t;", 'IF StrLen(t)>0 AND StrPart(t,1,1)="#" THEN TPWrite "no"; ENDIF')
    with pytest.raises(RapidRuntimeError, match="StrPart: position 1 is outside"):
        program.run()


def test_priorities(say):
    assert say(
        "TPWrite ValToStr(2+3*4-6/2); TPWrite ValToStr(1+1=2 OR 1=2 AND 1=2); TPWrite ValToStr(NOT 1=2);"
        "TPWrite ValToStr(7 DIV 2*10+7 MOD 4); TPWrite ValToStr(-2*3);"
    ) == ["11", "TRUE", "TRUE", "33", "-6"]


def test_strings_hold_80_characters(say, load):
    eighty = "x" * 80
    assert say(f'a:="{eighty}"; TPWrite a;', "VAR string a;") == [eighty]
    with pytest.raises(RapidRuntimeError, match="ERR_STRTOOLNG: a string of 81"):
        load("VAR string a;", f'a:="{eighty}"; a:=a+"y";').run()
    with pytest.raises(RapidSyntaxError, match="string of 81 characters"):
        load("VAR string a;", f'a:="{eighty}y";')


def test_quotes_and_backslashes_in_strings_are_doubled(say):
    assert say('TPWrite "a""b\\\\c\\0Ad";') == ['a"b\\c\nd']


def test_dnum_is_wider(say):
    assert say('d:=16777217; TPWrite "d"\\Dnum:=d-16777216;', "VAR dnum d;") == ["d1"]


def test_var_is_reset_and_pers_is_kept_when_the_program_starts_anew(load, machine):
    program = load("VAR num v:=1; PERS num p:=1;", 'v:=v+1; p:=p+1; TPWrite ValToStr(v)+" "+ValToStr(p);')
    program.run()
    program.run()
    program.run(reset=False)
    assert machine.lines == ["2 2", "2 3", "3 4"]


def test_local_names_hide_global_ones_and_modules_share_the_rest(machine):
    from doormill_ros.simulation.controller.rapid.program import RapidProgram

    main = "PROC main() VAR num b:=3; TPWrite ValToStr(a)+ValToStr(b); show; ENDPROC"
    one = f"MODULE one LOCAL VAR num a:=1; VAR num b:=2; {main} ENDMODULE"
    two = "MODULE two LOCAL VAR num a:=5; PROC show() TPWrite ValToStr(a)+ValToStr(b); ENDPROC ENDMODULE"
    RapidProgram([parse_module(one, "one"), parse_module(two, "two")], machine).run()
    assert machine.lines == ["13", "52"]


# Errors


def test_errors_go_to_the_handler_of_the_routine_and_on_with_raise(say):
    rest = """
    PROC inner() x:=1/0; TPWrite "not reached"; ERROR TPWrite "inner"; RAISE; ENDPROC
    PROC middle() inner; TPWrite "middle goes on"; ENDPROC
    """
    body = 'middle; TPWrite "after"; ERROR IF ERRNO=ERR_DIVZERO TPWrite "main"; TRYNEXT;'
    assert say(body, "VAR num x;", rest) == ["inner", "main", "after"]


def test_trynext_goes_on_behind_the_innermost_statement(say):
    assert say(
        'IF TRUE THEN x:=1/0; TPWrite "inside"; ENDIF TPWrite "outside"; ERROR TRYNEXT;', "VAR num x;"
    ) == ["inside", "outside"]


def test_retry_repeats_the_statement(say):
    assert say("TPWrite ValToStr(10/d); ERROR d:=d+4; RETRY;", "VAR num d:=0;") == ["2.5"]


def test_retry_gives_up_after_four(load):
    with pytest.raises(RapidRuntimeError, match="RETRY repeated line 4 4 times"):
        load("VAR num d;", "d:=1/d;\nERROR\nRETRY;").run()


def test_a_handler_that_returns_goes_on_in_the_caller(say):
    assert say(
        'p; TPWrite "caller";',
        "VAR num x;",
        'PROC p() x:=1/0; TPWrite "no"; ERROR TPWrite "handled"; RETURN; ENDPROC',
    ) == ["handled", "caller"]


@pytest.mark.parametrize(
    "handler", ['TPWrite "a";', "IF FALSE THEN RETRY; ENDIF", "TEST 1 CASE 2: TRYNEXT; ENDTEST"]
)
def test_a_handler_that_ends_without_a_decision_stops_the_program(load, handler):
    rest = f"PROC p() x:=1/0; ERROR {handler} ENDPROC"
    with pytest.raises(
        RapidRuntimeError, match=r"an ERROR clause ended without RETRY.*ERR_DIVZERO: division"
    ):
        load("VAR num x;", "p; ERROR TRYNEXT;", rest).run()


def test_an_error_within_a_handler_stops_the_program_whoever_calls(load):
    """What a controller does: the system's error handler takes it, not the caller's ERROR clause."""
    rest = "PROC p() x:=1/0;\nERROR\nx:=2/0; TRYNEXT; ENDPROC"
    with pytest.raises(RapidRuntimeError, match=r"test.mod, line 8: ERR_DIVZERO.*within an ERROR clause"):
        load("VAR num x;", "p; ERROR TRYNEXT;", rest).run()


def test_a_routine_that_a_handler_calls_may_take_its_own_errors(say):
    rest = 'PROC p() x:=2/0; ERROR TPWrite "own"; TRYNEXT; ENDPROC'
    assert say('x:=1/0; TPWrite "on"; ERROR p; TRYNEXT;', "VAR num x;", rest) == ["own", "on"]


@pytest.mark.parametrize("number", ["0", "91", "1.5", "-1", "ERR_DIVZERO"])
def test_a_number_that_a_program_may_not_raise_is_an_error_of_its_own(say, number):
    assert say(f"RAISE {number}; ERROR TPWrite ValToStr(ERRNO=ERR_ILLRAISE); TRYNEXT;") == ["TRUE"]


def test_a_handler_names_no_error_of_its_own(load):
    with pytest.raises(RapidProgramError, match="RAISE with a number stands in an ERROR clause"):
        load("VAR num x;", "x:=1/0; ERROR RAISE ERR_OUTOFBND;")


def test_errors_of_ones_own_are_booked(say):
    body = "BookErrNo ERR_MINE; RAISE ERR_MINE; ERROR TPWrite ValToStr(ERRNO=ERR_MINE); TRYNEXT;"
    assert say(body, "VAR errnum ERR_MINE:=-1;") == ["TRUE"]


def test_unhandled_errors_name_file_line_and_errno(load, machine):
    with pytest.raises(RapidRuntimeError, match=r"test.mod, line 5: ERR_DIVZERO: division by zero"):
        load("VAR num x;", "\nx:=1/0;").run()
    assert machine.entries[-1][:2] == ("error", "program stopped")


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("a{4}:=1;", "ERR_OUTOFBND: index 4 of an array of 3"),
        ("a{0}:=1;", "ERR_OUTOFBND"),
        ("a{1.5}:=1;", "ERR_OUTOFBND"),
        ("x:=3.4E38*10;", "ERR_NUM_LIMIT"),
        ("x:=1.5 MOD 2;", "ERR_ARGVALERR"),
        ("x:=Sqrt(-1);", "ERR_ARGVALERR"),
        ("q:=NOrient([0.1,0,0,0]);", "ERR_ILLQUAT"),
        ("SetDO doA,2;", "ERR_ARGVALERR"),
        ("WaitDI diB,1\\MaxTime:=3;", "ERR_WAIT_MAXTIME: WaitDI diB: not within 3 s"),
        ("endless;", "nested calls"),
        ("x:=nothing(1);", "ended without RETURN"),
    ],
)
def test_run_time_errors(load, body, words):
    rest = "PROC endless() endless; ENDPROC FUNC num nothing(num n) IF n=2 RETURN 1; ENDFUNC"
    with pytest.raises(RapidRuntimeError, match=words):
        load("VAR num a{3}; VAR num x; VAR orient q;", body, rest).run()


def test_a_time_flag_takes_the_place_of_the_error(say):
    assert say("WaitDI diB,1\\MaxTime:=3\\TimeFlag:=late; TPWrite ValToStr(late);", "VAR bool late;") == [
        "TRUE"
    ]


# What a controller would not load


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("x:=y;", "line 4: 'y' is not declared"),
        ('x:="a";', "the value is string, allowed is num"),
        ("c:=1;", "c is a constant"),
        ("FOR i FROM 1 TO 2 DO i:=3; ENDFOR", "i is a loop variable"),
        ("IF x THEN ENDIF", "the condition is num, allowed is bool"),
        ('x:=x+"a";', r"\+ does not take num and string"),
        ("x:=StrLen();", "StrLen has 0 arguments, allowed are 1"),
        ("x:=StrLen(1);", "argument Str of StrLen is num, allowed is string"),
        ("StrLen s;", "StrLen is a function"),
        ("x:=TPErase();", "TPErase is a procedure"),
        ("p.w:=1;", "pos has no component 'w'"),
        ("x:=a{1,2};", "'a' has 1 dimensions"),
        ("p:=[1,2];", r"\[...\] has 2 items, pos has 3"),
        ("Incr 3;", "argument Name of Incr is an expression"),
        ("Incr c;", "argument Name of Incr is CONST c"),
        ("MoveL t,v10,z0,mine;", "argument Tool of MoveL is VAR mine, allowed is PERS"),
        ("RETURN 1;", "RETURN has the wrong form"),
        ("RETRY;", "outside an ERROR clause"),
        ("SetDO diB,1;", "is signaldi, allowed is a configured signaldo"),
        ("SetDO doNone,1;", "no configured signal"),
        ("doA:=1;", "doA is a signal"),
        ("f:=f;", "data of that type cannot be assigned"),
        ("x:=1E39;", "beyond the range of num"),
    ],
)
def test_modules_that_a_controller_refuses(load, body, words):
    declarations = (
        "VAR num x; CONST num c:=1; VAR pos p; VAR num a{2}; VAR string s; "
        "VAR robtarget t; VAR tooldata mine; VAR iodev f;"
    )
    with pytest.raises(RapidProgramError, match=words) as caught:
        load(declarations, body)
    assert caught.value.data["file"] == "test.mod"
    assert caught.value.data["line"] == 4


@pytest.mark.parametrize(
    ("declarations", "words"),
    [
        ("VAR num x; VAR string X;", "declared twice"),
        ("VAR number x;", "data type 'number' is not known"),
        ("PERS num p;", "PERS p has no initial value"),
        ("VAR num x{0};", "dimension of 0"),
        ("VAR num x{3000000};", "dimension of 3E\\+06|dimension of 3e\\+06"),
        ("CONST num a:=b; CONST num b:=a;", "not declared"),
    ],
)
def test_declarations_that_a_controller_refuses(load, declarations, words):
    with pytest.raises(RapidProgramError, match=words):
        load(declarations)


def test_constants_may_be_declared_in_any_order(say):
    assert say("TPWrite ValToStr(a);", "CONST num a:=b*2; CONST num b:=3; VAR num l{a};") == ["6"]


# What is not executed is named


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("GOTO there;", "GOTO"),
        ("here: TPErase;", "a label"),
        ('%"name"% 1;', "a call by name"),
        ("MoveCDO p,p,v10,z0,tool0,doA,1;", "routine 'MoveCDO'"),
        ("MoveL t\\ID:=1,v10,z0,tool0;", r"MoveL has no optional argument \\ID"),
        ("IF NOT a AND b THEN ENDIF", "NOT before AND"),
        ("UNDO", "UNDO"),
        ("BACKWARD", "BACKWARD"),
    ],
)
def test_constructs_outside_the_subset_are_named_with_file_and_line(load, body, words):
    with pytest.raises(RapidUnsupportedError, match=words) as caught:
        load("VAR robtarget t; VAR bool a; VAR bool b;", "\n\n" + body)
    assert caught.value.data["file"] == "test.mod"
    assert caught.value.data["line"] == 6
    assert re.search(r"test.mod, line 6", caught.value.message)


@pytest.mark.parametrize("condition", ["a AND NOT b", "a OR NOT b", "NOT NOT a", "NOT a OR NOT b", "a=NOT b"])
def test_not_stands_first_or_in_parentheses(load, condition):
    """RAPID kernel, Expressions: a relation has no NOT, an expression may begin with one."""
    with pytest.raises(RapidSyntaxError, match="found 'NOT'"):
        load("VAR bool a; VAR bool b;", f"IF {condition} THEN ENDIF")


@pytest.mark.parametrize(
    ("condition", "holds"),
    [("NOT a OR b", False), ("a AND (NOT b)", True), ("(NOT b) AND a", True), ("NOT (a AND b)", True)],
)
def test_not_turns_what_follows_it(say, condition, holds):
    assert say(f"TPWrite ValToStr({condition});", "VAR bool a:=TRUE; VAR bool b:=FALSE;") == [
        str(holds).upper()
    ]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "line 1, column 1: found the end of the file, allowed is MODULE"),
        ("MODULE a\nPROC b(\nENDMODULE", "line 3, column 1: found 'ENDMODULE'"),
        (
            "MODULE a\nVAR num poscf1\nVAR num poscf4;\nENDMODULE",
            "line 3, column 1: found 'VAR', allowed is .*';'",
        ),
        ("MODULE a\nPROC p()\nx:=1\nENDPROC ENDMODULE", "line 4"),
        ("MODULE a\rENDMODULE", "line 1: found a carriage return"),
        ("MODULE a VAR num x:=1E999; ENDMODULE", "allowed is a number"),
        ("MODULE " + "a" * 33 + " ENDMODULE", "at most 32 characters"),
        ('MODULE a CONST string s:="unfinished;\nENDMODULE', "line 1, column 26"),
        (
            "MODULE a PROC p() x:=" + "(" * 5000 + "1" + ")" * 5000 + "; ENDPROC ENDMODULE",
            "nested too deeply",
        ),
    ],
)
def test_what_is_no_rapid_is_named_with_line_and_column(text, words):
    with pytest.raises(RapidSyntaxError, match=words):
        parse_module(text, "broken.mod")


def test_old_headers_comments_and_crlf_are_skipped():
    text = "%%%\r\n  VERSION:1\r\n  LANGUAGE:ENGLISH\r\n%%%\r\nMODULE a(SYSMODULE) ! note; ENDMODULE\r\nENDMODULE\r\n"
    module = parse_module(text)
    assert (module.name, module.attributes) == ("a", ("SYSMODULE",))


def test_a_handler_runs_once_although_the_error_came_from_a_nested_block(say):
    rest = 'PROC p() IF TRUE THEN x:=1/0; ENDIF ERROR TPWrite "handler"; RAISE; ENDPROC'
    assert say("p; ERROR TRYNEXT;", "VAR num x;", rest) == ["handler"]
