"""Traps while the robot moves: when they come, and what they do with the path."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doormill_ros.simulation.controller.rapid.errors import (
    RapidRuntimeError,
    RapidStoppedError,
    RapidUnsupportedError,
)

EIO = """EIO:CFG_1.0:6:1::
EIO_SIGNAL:

      -Name "diB" -SignalType "DI"

      -Name "doA" -SignalType "DO"
"""
DATA = """PERS tooldata tMill:=[TRUE,[[0,0,250],[1,0,0,0]],[20,[0,0,120],[1,0,0,0],0,0,0]];
VAR intnum i; VAR robtarget a; VAR robtarget p;"""
#: 600 mm at 100 mm/s, so 6 s, and the input comes after 2 s.
BODY = """ConfL\\Off; a:=CRobT(\\Tool:=tMill); CONNECT i WITH t; ISignalDI diB,high,i;
MoveL Offs(a,0,300,0),v100,z1,tMill; MoveL Offs(a,0,600,0),v100,fine,tMill; SetDO doA,1;"""


@pytest.fixture
def run(tmp_path: Path, controller):
    """Run a module whose trap has this body; diB rises after two seconds."""

    def run_(trap: str, body: str = BODY, cycles: int = 1, **kwargs):
        (tmp_path / "EIO.cfg").write_text(EIO)
        module = tmp_path / "traps.mod"
        module.write_text(
            f"MODULE traps\n{DATA}\nPROC main()\n{body}\nENDPROC\nTRAP t\n{trap}\nENDTRAP\nENDMODULE\n"
        )
        robot = controller(
            modules=[module],
            expected_door=None,
            io_configuration=tmp_path / "EIO.cfg",
            on_time=lambda c: c.cell.set_input("diB", float(c.now() >= 2.0)),
            **kwargs,
        )
        robot.run(cycles=cycles)
        return robot

    return run_


def way(robot) -> np.ndarray:
    """Path along y from the start [mm]."""
    y = robot.executed_path().T_base_tool_commanded[:, 1, 3] * 1e3
    return y - y[0]


def test_a_stop_in_a_trap_is_on_the_path_and_late(run):
    """The trap comes at most 120 ms and one look after the event."""
    robot = run('StopMove; TPWrite "y"\\Pos:=CPos(\\Tool:=tMill); StartMove;')
    (line,) = robot.pendant_lines
    y = float(line[2:].split(",")[1])
    assert 190.0 + 10.0 < y < 190.0 + 25.0
    assert way(robot)[-1] == pytest.approx(600.0, abs=1e-3)
    assert robot.read_signal("doA") == 1.0


def test_a_robot_that_a_trap_stopped_never_arrives(run):
    with pytest.raises(RapidStoppedError):
        run("StopMove;")


def test_a_path_is_put_aside_and_taken_up_again(run):
    robot = run("""StopMove; StorePath; p:=CRobT(\\Tool:=tMill); MoveL Offs(p,-100,0,0),v500,fine,tMill;
    MoveL p,v500,fine,tMill; RestoPath; StartMove;""")
    x = robot.executed_path().T_base_tool_commanded[:, 0, 3] * 1e3
    assert (x - x[0]).min() == pytest.approx(-100.0, abs=0.01)
    assert x[-1] == pytest.approx(x[0], abs=0.01)
    assert way(robot)[-1] == pytest.approx(600.0, abs=1e-3)
    assert robot.read_signal("doA") == 1.0


def test_a_cleared_path_is_forgotten_and_the_cycle_begins_anew(run):
    robot = run("IDelete i; StopMove; ClearPath; StartMove; ExitCycle;")
    assert robot.read_signal("doA") == 0.0
    assert 200.0 < way(robot)[-1] < 230.0


@pytest.mark.parametrize("trap", ["StopMove\\Quick;", "PathRecMoveBwd;"])
def test_what_not_every_controller_has_is_refused(run, trap):
    with pytest.raises(RapidUnsupportedError):
        run(trap)


def test_going_on_far_from_the_path_is_refused(run):
    with pytest.raises(RapidRuntimeError, match="ERR_PATHDIST"):
        run("""StopMove; StorePath; p:=CRobT(\\Tool:=tMill); MoveL Offs(p,-100,0,0),v500,fine,tMill;
        RestoPath; StartMove;""")


@pytest.mark.parametrize(
    ("trap", "words"),
    [("StopMove; StorePath; StorePath;", "stored already"), ("StopMove; RestoPath;", "no path is stored")],
)
def test_paths_are_stored_once(run, trap, words):
    with pytest.raises(RapidRuntimeError, match=words):
        run(trap)
