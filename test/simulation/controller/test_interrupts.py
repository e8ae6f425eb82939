"""Interrupts: what orders them, when their traps run, and what leaves a trap."""

from __future__ import annotations

import pytest

from doormill_ros.simulation.controller.rapid.errors import RapidProgramError, RapidRuntimeError

TRAP = "TRAP t TPWrite ValToStr(INTNO); ENDTRAP"


@pytest.fixture
def plant(machine):
    """Let signals change at simulated times: `plant((0.5, "diB", 1), ...)`."""
    return machine.plan.extend


def test_an_input_interrupts_a_wait(say, plant):
    plant([(0.5, "diB", 1.0)])
    body = 'CONNECT i WITH t; ISignalDI diB,high,i; WaitTime 1; TPWrite "waited";'
    assert say(body, "VAR intnum i;", TRAP) == ["1", "waited"]


def test_a_trap_runs_before_the_next_instruction(say, plant):
    plant([(0.001, "diB", 1.0)])
    body = 'CONNECT i WITH t; ISignalDI diB,high,i; FOR k FROM 1 TO 9000 DO n:=n+seen; ENDFOR TPWrite "n"\\Num:=n;'
    (line,) = say(body, "VAR intnum i; VAR num n; VAR num seen;", "TRAP t seen:=1; ENDTRAP")
    assert 0 < int(line[1:]) < 9000


def test_a_level_that_was_there_before_is_no_event(say, plant):
    plant([(0.0, "diB", 1.0), (0.2, "diB", 0.0), (0.4, "diB", 1.0)])
    body = 'CONNECT i WITH t; ISignalDI diB,1,i; WaitTime 0.3; TPWrite "low"; WaitTime 0.3;'
    assert say("WaitDI diB,1; " + body, "VAR intnum i;", TRAP) == ["low", "1"]


@pytest.mark.parametrize(
    ("order", "times"),
    [
        ("ISignalDI diB,high,i", 2),
        ("ISignalDI diB,low,i", 2),
        ("ISignalDI diB,edge,i", 4),
        ("ISignalDI\\Single,diB,edge,i", 1),
    ],
)
def test_edges(say, plant, order, times):
    plant([(0.1, "diB", 1.0), (0.2, "diB", 0.0), (0.3, "diB", 1.0), (0.4, "diB", 0.0)])
    assert say(f"CONNECT i WITH t; {order}; WaitTime 1;", "VAR intnum i;", TRAP) == ["1"] * times


def test_a_timer_comes_again_until_it_is_deleted(say):
    body = "CONNECT i WITH t; ITimer 0.3,i; WaitTime 1; IDelete i; WaitTime 1;"
    assert say(body, "VAR intnum i;", TRAP) == ["1"] * 3


def test_a_single_timer_comes_once(say, machine):
    trap = 'TRAP t TPWrite "at"\\Num:=Round(ClkRead(c)\\Dec:=2); ENDTRAP'
    assert say(
        "CONNECT i WITH t; ClkStart c; ITimer\\Single,0.05,i; WaitTime 1;", "VAR intnum i; VAR clock c;", trap
    ) == ["at0.06"]


def test_a_change_of_persistent_data_interrupts(say):
    body = 'CONNECT i WITH t; IPers p,i; WaitTime 0.1; p.x:=2; WaitTime 0.1; p.x:=2; WaitTime 0.1; TPWrite "end";'
    trap = "TRAP t TPWrite ValToStr(p); ENDTRAP"
    assert say(body, "VAR intnum i; PERS pos p:=[1,0,0];", trap) == ["[2,0,0]", "end"]


def test_the_programs_own_output_interrupts(say):
    assert say("CONNECT i WITH t; ISignalDO doA,1,i; Set doA; WaitTime 1;", "VAR intnum i;", TRAP) == ["1"]


def test_disabled_interrupts_queue_in_their_order(say, plant):
    plant([(0.1, "diB", 1.0), (0.2, "diB", 0.0), (0.3, "diB", 1.0)])
    body = """CONNECT i WITH t; CONNECT k WITH t; ISignalDI diB,1,k; ISignalDI diB,0,i;
    IDisable; WaitTime 1; TPWrite "enabled"; IEnable; WaitTime 1;"""
    assert say(body, "VAR intnum i; VAR intnum k;", TRAP) == ["enabled", "2", "1", "2"]


def test_sleeping_interrupts_are_disregarded(say, plant):
    plant([(0.1, "diB", 1.0), (1.2, "diB", 0.0), (1.3, "diB", 1.0)])
    body = 'CONNECT i WITH t; ISignalDI diB,1,i; ISleep i; WaitTime 1; TPWrite "awake"; IWatch i; WaitTime 1;'
    assert say(body, "VAR intnum i;", TRAP) == ["awake", "1"]


def test_a_trap_is_not_interrupted_but_the_event_waits(say, plant):
    plant([(0.1, "diB", 1.0), (0.2, "diB", 0.0)])
    trap = 'TRAP t TPWrite "in"; WaitTime 0.5; TPWrite "out"; ENDTRAP'
    body = "CONNECT i WITH t; ISignalDI diB,edge,i; WaitTime 1;"
    assert say(body, "VAR intnum i;", trap) == ["in", "out", "in", "out"]


def test_a_wait_in_a_trap_has_its_own_limit(load, plant):
    plant([(0.1, "diB", 1.0)])
    rest = "TRAP t WaitDI diB,0\\MaxTime:=0.5; ENDTRAP"
    program = load("VAR intnum i;", "CONNECT i WITH t; ISignalDI diB,1,i; WaitTime 3; ERROR TRYNEXT;", rest)
    with pytest.raises(RapidRuntimeError, match=r"ERR_WAIT_MAXTIME: WaitDI diB.*it left trap t"):
        program.run()


def test_a_trap_may_take_its_own_errors(say, plant):
    plant([(0.1, "diB", 1.0)])
    rest = 'TRAP t WaitDI diB,0\\MaxTime:=0.5; ERROR TPWrite "late"; RETURN; ENDTRAP'
    assert say('CONNECT i WITH t; ISignalDI diB,1,i; WaitTime 3; TPWrite "on";', "VAR intnum i;", rest) == [
        "late",
        "on",
    ]


def test_raise_in_a_trap_stops_the_program_although_main_has_a_handler(load, plant):
    plant([(0.1, "diB", 1.0)])
    rest = "TRAP t RAISE 5; ERROR RETURN; ENDTRAP"
    program = load("VAR intnum i;", "CONNECT i WITH t; ISignalDI diB,1,i; WaitTime 3; ERROR TRYNEXT;", rest)
    with pytest.raises(RapidRuntimeError, match="RAISE 5 in a trap routine"):
        program.run()


@pytest.mark.parametrize("end", ["EXIT", "ExitCycle", "Stop", "Break"])
def test_a_trap_can_end_the_program(load, machine, plant, end):
    plant([(0.1, "diB", 1.0)])
    body = 'CONNECT i WITH t; ISignalDI diB,1,i; WaitTime 3; TPWrite "not reached";'
    load("VAR intnum i;", body, f"TRAP t {end}; ENDTRAP").run()
    assert machine.lines == []
    assert machine.now() < 0.2


def test_interrupts_live_on_in_the_next_cycle_and_end_with_the_pointer_in_main(load):
    program = load("VAR intnum i;", "CONNECT i WITH t;", TRAP)
    program.run()
    with pytest.raises(RapidRuntimeError, match="ERR_ALRDYCNT"):
        program.run(reset=False)
    program.run()


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("CONNECT i WITH t; CONNECT i WITH t;", "ERR_ALRDYCNT"),
        ("ISignalDI diB,1,i;", "ERR_UNKINO: ISignalDI"),
        ("CONNECT i WITH t; ISignalDI diB,1,i; ISignalDI diB,0,i;", "ordered already"),
        ("ISleep i;", "ERR_UNKINO: ISleep"),
        ("IWatch i;", "ERR_UNKINO: IWatch"),
        ("CONNECT i WITH t; ITimer 0.05,i;", "ERR_ARGVALERR: ITimer 0.05 s"),
        ("CONNECT i WITH t; ISignalDI diB,3,i;", "allowed are low, high and edge"),
        ("FOR k FROM 1 TO 71 DO CONNECT l{k} WITH t; ENDFOR", "ERR_INOMAX: CONNECT: more than 70"),
    ],
)
def test_interrupts_that_cannot_be(load, body, words):
    with pytest.raises(RapidRuntimeError, match=words):
        load("VAR intnum i; VAR intnum l{80};", body, TRAP).run()


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("CONNECT i WITH p;", "'p' is no trap routine"),
        ("CONNECT i WITH nothing;", "'nothing' is no trap routine"),
        ("CONNECT c WITH t;", "c is CONST num, allowed is VAR intnum"),
        ("t;", "t is a trap"),
        ("ISignalDI doA,1,i;", "is signaldo, allowed is a configured signaldi"),
        ("IPers v,i;", "is VAR v, allowed is PERS"),
    ],
)
def test_interrupts_that_a_controller_does_not_load(load, body, words):
    with pytest.raises(RapidProgramError, match=words):
        load("VAR intnum i; CONST num c:=1; VAR num v;", body, TRAP + " PROC p() ENDPROC")
