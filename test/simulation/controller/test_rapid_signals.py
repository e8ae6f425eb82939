"""Instructions and functions of signals, and waiting for them."""

from __future__ import annotations

import pytest

from doormill_ros.simulation.controller.rapid.errors import RapidRuntimeError


def test_groups_hold_numbers(say, machine):
    body = (
        "SetGO goD,7; TPWrite ValToStr(GOutput(goD)); TPWrite ValToStr(giE); TPWrite ValToStr(GInput(giE)+1);"
    )
    machine.signals["giE"] = 12.0
    assert say(body) == ["7", "12", "13"]
    assert machine.signals["goD"] == 7.0


@pytest.mark.parametrize(
    ("wait", "until"),
    [
        ("WaitGI giE,5", 0.2),
        ("WaitGI giE\\NOTEQ,0", 0.1),
        ("WaitGI giE\\GT,3", 0.2),
        ("WaitGI giE\\LT,5\\MaxTime:=9", 0.0),
    ],
)
def test_waiting_for_a_group(say, machine, wait, until):
    machine.plan.extend([(0.1, "giE", 2.0), (0.2, "giE", 5.0)])
    say(f"{wait};")
    assert machine.now() == pytest.approx(until, abs=0.002)


@pytest.mark.parametrize(
    ("rate", "until"), [("", 0.3), ("\\PollRate:=0.16", 0.32), ("\\PollRate:=0.04", 0.24)]
)
def test_wait_until_looks_now_and_then(say, machine, rate, until):
    machine.plan.extend([(0.21, "giE", 5.0)])
    say(f"WaitUntil giE=5{rate};")
    assert machine.now() == pytest.approx(until, abs=0.01)


def test_wait_until_misses_what_is_over_before_it_looks(say, machine):
    machine.plan.extend([(0.21, "giE", 5.0), (0.25, "giE", 0.0)])
    assert say("WaitUntil giE=5\\MaxTime:=1\\TimeFlag:=f; TPWrite ValToStr(f);", "VAR bool f;") == ["TRUE"]


def test_a_change_of_a_group_interrupts(say, machine):
    machine.plan.extend([(0.1, "giE", 2.0), (0.2, "giE", 5.0)])
    body = "CONNECT i WITH t; ISignalGI giE,i; WaitTime 1;"
    assert say(body, "VAR intnum i;", "TRAP t TPWrite ValToStr(giE); ENDTRAP") == ["2", "5"]


def test_what_a_group_had_when_time_ran_out(say, machine):
    machine.signals["goD"] = 3.0
    body = "WaitGO goD,4\\MaxTime:=1\\ValueAtTimeout:=v\\TimeFlag:=f; TPWrite ValToStr(v)+ValToStr(f);"
    assert say(body, "VAR num v; VAR bool f;") == ["3TRUE"]


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("WaitGI giE,4\\MaxTime:=1;", "ERR_WAIT_MAXTIME: WaitGI giE"),
        ("SetGO goD,1.5;", "ERR_ARGVALERR: SetGO goD"),
        ("WaitUntil giE=5\\PollRate:=0.01;", "ERR_ARGVALERR: WaitUntil .PollRate 0.01"),
        ("WaitUntil giE=5\\MaxTime:=1;", "ERR_WAIT_MAXTIME: WaitUntil"),
    ],
)
def test_signals_that_go_wrong(load, body, words):
    with pytest.raises(RapidRuntimeError, match=words):
        load("", body).run()
