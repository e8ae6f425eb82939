"""A robot that was jogged after a stop is never led along a way that was planned from elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.simulation.controller.motions.limits import load_limits
from doormill_ros.simulation.controller.operation.execution import Execution
from doormill_ros.simulation.controller.rapid.errors import RapidStoppedError

HOME = [0.0, -40.0, 30.0, 0.0, 10.0, 0.0]
BY_HAND = "Jog it clear of the door and run MoveHome."
#: As far as public backups of controllers let a program go back to its path in automatic mode.
FAR_REGAIN = replace(load_limits(), regain_distance=0.5, regain_turn=3.0)
ON_A_WAY, IN_THE_LOCK = 76, 105  #: motions of the standard door
COASTING = 3.0  #: in which a spindle comes to rest [s]
JOGGED = np.radians([5.0, -5.0, 0.0, 0.0, 0.0, 0.0])


@pytest.fixture
def stopped(door, controller):
    """A robot with the standard door's file that is stopped, jogged and started again."""

    def stopped_(motion: int, jogged, start=None, **kwargs):
        done: list[float] = []

        def stop(c):
            if not done and c.moving and c.program.read("millingMotion") >= motion:
                done.append(c.now())
                c.panel.stop()

        def people(c):
            if c.now() < done[0] + COASTING:
                return
            if len(done) == 1:
                done.append(c.now())
                c._engine.q = np.array(c.q) + jogged
                c._engine.planned_q = c._engine.q.copy()
                if start is not None:
                    start(c)
                c.panel.start()
            elif c.panel.state.pointer_lost:  # what waited for its turn cannot be moved from there
                c.panel.pointer_to_main()
                c.panel.start()

        robot = controller(patience=None, on_time=stop, on_stopped=people, **kwargs)
        (robot.home / signals.TARGET_FILE).write_bytes(render_target_file(door("standard_door"), "run-1"))
        robot.asked = []

        def operator(dialog):
            robot.asked.append(dialog.lines)
            if len(robot.asked) > 1 or "MoveHome" in dialog.lines[1]:
                robot.stop()
            return dialog.buttons[0][0]

        robot.teach_pendant.operator = operator
        return robot

    return stopped_


def asked_after(robot) -> list[tuple[str, ...]]:
    """What the pendant asks until somebody has to do something by hand, or the robot is home."""
    try:
        robot.run()
        if not robot.asked:  # the door ended; the next cycle of main leads back
            begun = robot.now()
            robot._on_time = lambda c: c.now() > begun + 60.0 and c.stop()
            robot.clamped = 1.0
            robot.run(reset=False)
    except RapidStoppedError:
        pass
    return robot.asked


def test_a_robot_that_stands_where_it_stopped_is_led_back(stopped):
    asked = asked_after(stopped(ON_A_WAY, np.zeros(6), limits=FAR_REGAIN))
    assert asked[0][1] == "Retract and go home?"


@pytest.mark.parametrize("motion", [ON_A_WAY, IN_THE_LOCK])
def test_a_jogged_robot_is_jogged_home(stopped, motion):
    robot = stopped(motion, JOGGED, limits=FAR_REGAIN)
    asked = asked_after(robot)
    assert set(asked) == {("The robot was moved by hand.", BY_HAND)}


def without_stop_events(monkeypatch):
    """Errors stop a program without its STOP event."""
    event = Execution._event
    monkeypatch.setattr(
        Execution,
        "_event",
        lambda self, name, *a: None if name in ("STOP", "QSTOP") else event(self, name, *a),
    )


@pytest.mark.parametrize("to_main", [True, False])
def test_where_no_event_told_of_the_stop_the_robot_may_have_been_jogged(stopped, monkeypatch, to_main):
    without_stop_events(monkeypatch)
    start = (lambda c: c.panel.pointer_to_main()) if to_main else None
    asked = asked_after(stopped(ON_A_WAY, JOGGED, start, limits=FAR_REGAIN))
    assert set(asked) == {("The robot was moved by hand.", BY_HAND)}


def test_in_its_slot_the_path_tells_where_it_stands(stopped, monkeypatch):
    without_stop_events(monkeypatch)
    asked = asked_after(stopped(IN_THE_LOCK, np.zeros(6), lambda c: c.panel.pointer_to_main()))
    assert asked[0][1] == "Retract and go home?"


@pytest.mark.parametrize("motion", [IN_THE_LOCK, 108, 112, 120])
def test_a_stop_that_no_event_told_of_is_not_gone_on_from(stopped, monkeypatch, motion):
    """The spindle coasts while the program stands: its tool would be dragged through the wood."""
    without_stop_events(monkeypatch)
    robot = stopped(motion, np.zeros(6))
    cuts: list[bool] = []
    stop = robot._on_time

    def watch(c):
        stop(c)
        if c.panel.running and c.moving and c.context.cutting and c.read_signal("doSpindleOn"):
            cuts.append(c.read_signal("diSpindleAtSpeed") == 0.0)

    robot._on_time = watch
    asked_after(robot)
    assert cuts
    assert not any(cuts)
    assert robot.io.read("doPathFault") == 1


@pytest.mark.parametrize("reset", [True, False])
def test_who_jogged_it_clear_runs_move_home(door, controller, reset):
    """A start holds a robot whose door ended; MoveHome is what the pendant asks for then."""

    def lose(c):
        if c.moving and c.program.read("millingMotion") >= IN_THE_LOCK:
            c.cell.set_input("diSpindleAtSpeed", 0.0)

    robot = controller(patience=None, on_time=lose)
    (robot.home / signals.TARGET_FILE).write_bytes(render_target_file(door("standard_door"), "run-1"))
    robot.run()
    assert robot.program.read("stopReason") != 0.0
    robot._engine.q = np.array(robot.q) + JOGGED
    robot._engine.planned_q = robot._engine.q.copy()
    begun = robot.now()
    robot._on_time = lambda c: c.now() > begun + 30.0 and c.stop()
    robot.run("MoveHome", reset=reset)
    assert np.allclose(np.degrees(robot.q), HOME, atol=1e-3)


@pytest.mark.parametrize("off", [0.9, -0.9])
def test_a_path_begins_at_home_itself(door, controller, off):
    """What counts as home may be centimetres off, and the first way was planned from there with a few millimetres."""
    beside = np.array(HOME) + off * np.array([1.0, 1.0, -1.0, 1.0, 1.0, 1.0])
    robot = controller(start=np.radians(beside))
    (robot.home / signals.TARGET_FILE).write_bytes(render_target_file(door("thesis_190_0deg"), "run-1"))
    robot.run()
    assert robot.pendant_lines[-1] == "Door is milled."
    recording = robot.recording
    first = next(i for i, context in enumerate(recording.context) if context.index >= 0)
    assert np.allclose(np.degrees(recording.q[first]), HOME, atol=1e-3)
    assert robot.teach_pendant.dialogs == []
