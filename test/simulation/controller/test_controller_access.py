"""Access levels of signals: RAPID is one of the writers that a level names, or is not."""

from __future__ import annotations

from pathlib import Path

import pytest

from doormill_ros.simulation.controller.rapid.errors import RapidRuntimeError

EIO = """EIO:CFG_1.0:6:1::
EIO_SIGNAL:

      -Name "doDefault" -SignalType "DO"

      -Name "doAll" -SignalType "DO" -Access "All"

      -Name "doReadOnly" -SignalType "DO" -Access "ReadOnly"

      -Name "doInternal" -SignalType "DO" -Access "Internal"

      -Name "doNetwork" -SignalType "DO" -Access "Network"

      -Name "goReadOnly" -SignalType "GO" -Size 4 -Access "ReadOnly"

      -Name "aoReadOnly" -SignalType "AO" -MaxLog 10 -Access "ReadOnly"

      -Name "aoSpeed" -SignalType "AO" -MinLog -10 -MaxLog 10
      -Access "Default"

      -Name "goNumber" -SignalType "GO" -Size 4
#
EIO_ACCESS:

      -Name "Network" -RemoteManual -RemoteAuto
""".replace("-MaxLog 10\n      -Access", "-MaxLog 10\\\n      -Access")


@pytest.fixture
def run(tmp_path: Path, controller):
    def run_(body: str, declarations: str = ""):
        (tmp_path / "EIO.cfg").write_text(EIO)
        module = tmp_path / "access.mod"
        module.write_text(f"MODULE access\n{declarations}\nPROC main()\n{body}\nENDPROC\nENDMODULE\n")
        robot = controller(modules=[module], expected_door=None, io_configuration=tmp_path / "EIO.cfg")
        robot.failure = None
        try:
            robot.run()
        except RapidRuntimeError as error:
            robot.failure = error
        return robot

    return run_


@pytest.mark.parametrize("signal", ["doDefault", "doAll"])
def test_rapid_writes_what_its_level_lets_it(run, signal):
    robot = run(f"SetDO {signal},1; Reset {signal}; Set {signal};")
    assert robot.failure is None
    assert robot.read_signal(signal) == 1.0


@pytest.mark.parametrize(
    ("instruction", "signal"),
    [
        ("SetDO doReadOnly,1", "doReadOnly"),
        ("Set doReadOnly", "doReadOnly"),
        ("Reset doReadOnly", "doReadOnly"),
        ("SetDO doInternal,1", "doInternal"),
        ("SetDO doNetwork,1", "doNetwork"),
        ("SetGO goReadOnly,1", "goReadOnly"),
        ("SetAO aoReadOnly,1", "aoReadOnly"),
    ],
)
def test_the_program_stops_at_the_very_write_of_a_signal_it_may_not_write(run, instruction, signal):
    """The line is named, no ERROR clause takes it, and what follows is not executed."""
    robot = run(f"SetDO doDefault,1;\nSetDO doAll,1;\n{instruction};\nReset doDefault;\nERROR\nTRYNEXT;")
    assert robot.failure.data["line"] == 6
    assert f"signal {signal} has access level" in robot.failure.message
    assert [robot.read_signal(name) for name in ("doDefault", "doAll", signal)] == [1.0, 1.0, 0.0]
    last = robot.event_log[-1]
    assert (last.kind, last.number) == ("error", 10020)
    assert "access.mod, line 6" in last.text


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("SetAO aoSpeed,10.5;", "ERR_AO_LIM: signal aoSpeed cannot become 10.5, allowed is -10 to 10"),
        ("SetAO aoSpeed,-11;", "ERR_AO_LIM"),
        ("SetGO goNumber,16;", "ERR_GO_LIM: signal goNumber cannot become 16, allowed is 0 to 15"),
        ("SetGO goNumber,-1;", "ERR_GO_LIM"),
    ],
)
def test_values_beyond_a_signals_limits_are_errors_that_a_handler_may_take(run, body, words):
    assert words in run(body).failure.message
    robot = run(f"{body} ERROR TRYNEXT;")
    assert robot.failure is None
    assert [entry.title for entry in robot.event_log] == ["error taken"]


def test_the_system_sets_what_the_program_may_not(run):
    robot = run("SetDO doDefault,1;")
    robot.cell.force("doReadOnly", 1.0)
    assert robot.read_signal("doReadOnly") == 1.0


def test_events_have_number_severity_text_and_time(run):
    robot = run('WaitTime 1.5; ErrWrite "a","b"; ErrWrite\\W,"c","d"; ErrWrite\\I,"e","f"\\RL2:="g";')
    assert [(e.number, e.kind, e.title, e.text) for e in robot.event_log] == [
        (80001, "error", "a", "b"),
        (80002, "warning", "c", "d"),
        (80003, "information", "e", "f g"),
    ]
    assert all(1.5 <= entry.time < 1.51 for entry in robot.event_log)
