"""What ends a door before its time, on the project's own modules: seen, told, and led back to home."""

from __future__ import annotations

import numpy as np
import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.simulation.controller.operation.states import OperatingMode
from support.door_cutting import next_cycle, operator
from support.rapid_bench import answer

HOME = [0.0, -40.0, 30.0, 0.0, 10.0, 0.0]


def assert_led_home(robot, reason: str) -> None:
    """Spindle off, robot retracted and home, the fault told with its reason, nothing milled on."""
    assert robot.happened
    assert robot.read_signal("doSpindleOn") == 0.0
    assert np.allclose(np.degrees(robot.q), HOME, atol=1e-3)
    assert [robot.io.read(s) for s in ("doPathFault", "doPathBusy", "doPathDone")] == [1, 0, 0]
    asked = [dialog.lines for dialog in robot.teach_pendant.dialogs]
    assert asked == [
        (reason, "Retract and go home?"),
        (reason, "This door is spoilt. Go on with the next."),
    ]
    assert (robot.home / signals.REFUSED_FILE).read_text() == f"1\n{reason}\n"
    assert robot.program.read("doorInHand") is False


def fail(cell, signal: str) -> None:
    """An input falls; that of the drawbar because the plant has lost the tool."""
    if signal == "diToolClamped":
        cell.rack.carried = ""
    else:
        cell.set_input(signal, 0.0)


@pytest.mark.parametrize(
    ("signal", "reason"),
    [
        ("diSpindleAtSpeed", "The spindle lost its speed."),
        ("diDoorClamped", "The door was released while milling."),
        ("diToolClamped", "The tool is not clamped in the spindle."),
    ],
)
@pytest.mark.parametrize("motion", [3, 9])
def test_what_fails_in_the_cut_ends_the_door_on_the_path(cutting, signal, reason, motion):
    robot = cutting(motion, lambda c: fail(c.cell, signal))
    robot.run()
    stopped = robot.now()
    assert stopped - robot.happened[0] < 1.0
    assert not robot.moving
    assert robot.read_signal("doSpindleOn") == 0.0
    moves = len(robot.moves)
    next_cycle(robot)
    assert_led_home(robot, reason)
    # Back along the path to in front of the feature, over the points, home.
    back = [move.kind for move in robot.moves[moves:]]
    out = back.index("MoveAbsJ")
    assert {"MoveC"} <= set(back[:out]) <= {"MoveC", "MoveL"}
    assert set(back[out:]) == {"MoveAbsJ"}


@pytest.mark.parametrize("motion", [3, 9])
def test_an_open_guard_ends_the_door_where_the_controller_itself_does_not_stop(cutting, motion):
    """In manual mode the safety chain lets the robot move with an open guard: the trap alone sees it."""
    robot = cutting(motion, lambda c: c.panel.open_guard())
    robot.panel.set_mode(OperatingMode.MANUAL_REDUCED)
    robot.panel.motors(True)
    robot.run()
    assert robot.panel.motors_on
    assert robot.now() - robot.happened[0] < 1.0
    assert not robot.moving
    assert robot.read_signal("doSpindleOn") == 0.0
    assert not any(entry.number == 10005 for entry in robot.event_log)  # nobody stopped the program
    next_cycle(robot)
    assert_led_home(robot, "The guard was opened while milling.")


@pytest.mark.parametrize("what", ["stop", "emergency_stop", "open_guard", "fail_power"])
@pytest.mark.parametrize("motion", [3, 9])
def test_a_stop_in_the_cut_is_not_gone_on_from(cutting, what, motion):
    robot = cutting(motion, lambda c: getattr(c.panel, what)(), on_stopped=operator)
    robot.run()
    next_cycle(robot)
    assert_led_home(robot, "The robot was stopped while milling.")
    recording = robot._engine.recording
    assert len(recording.time) > 2


@pytest.mark.parametrize("motion", [3, 9])
def test_a_stop_just_behind_the_start_ends_the_door_with_the_next_one(cutting, motion):
    """The program is stopped again before the trap of going on has run."""
    robot = cutting(motion, lambda c: c.panel.stop(), on_stopped=operator)
    again: list[float] = []
    before = robot._on_time

    def watch(c):
        before(c)
        if not again and c.read_signal("doMillAbort") and c.panel.running:
            again.append(c.now())
            c.panel.stop()
        if again and c.now() > again[0] + 60.0:
            c.stop()

    robot._on_time = watch
    robot.run()
    assert again
    next_cycle(robot)
    assert_led_home(robot, "The robot was stopped while milling.")


@pytest.mark.parametrize("power", [True, False])
def test_a_door_that_may_have_been_exchanged_before_the_spindle_ran_is_not_cut(door, controller, power):
    """The robot waits for the guard with the path in memory; nobody sees the clamp while the program stands."""

    def exchange(c):
        c.cell.set_input("diDoorClamped", 0.0)
        c.cell.set_input("diDoorClamped", 1.0)
        operator(c)

    def watch(c):
        if not stopped and "Close the guard." in c.pendant_lines:
            stopped.append(c.now())
            (c.panel.stop if power else c.panel.fail_power)()

    stopped: list[float] = []
    robot = controller(patience=None, on_stopped=exchange, on_time=watch)
    robot.teach_pendant.operator = lambda dialog: dialog.buttons[0][0]
    (robot.home / signals.TARGET_FILE).write_bytes(render_target_file(door("thesis_190_0deg"), "run-1"))
    robot.panel.set_mode(OperatingMode.MANUAL_REDUCED)
    robot.panel.motors(True)
    robot.panel.open_guard()
    robot.run()
    assert stopped
    assert robot.moves == []
    assert robot.io.read("doPathFault") == 1
    next_cycle(robot)
    assert robot.moves == []
    assert (robot.home / signals.REFUSED_FILE).read_text() == "1\nThe robot was stopped while milling.\n"


def test_no_spindle_starts_with_a_tool_that_is_not_clamped(cutting):
    robot = cutting(1, lambda c: None)
    turned: list[float] = []

    def loosen(c):
        c.cell.set_input("diToolClamped", 0.0)
        turned.append(c.read_signal("doSpindleOn"))

    robot._on_time = loosen
    robot.run()
    assert not any(turned)
    assert (robot.home / signals.REFUSED_FILE).read_text() == "1\nThe tool is not clamped in the spindle.\n"


def test_the_clamp_may_open_only_beside_a_mill_at_rest(cutting):
    """doPathBusy falls, and doPathDone rises, once the spindle stands: people go to the door then."""
    robot = cutting(10**6, lambda c: None)
    coasts, seen = [True], set()

    def watch(c):
        if coasts[0]:
            c.cell.set_input("diSpindleStopped", 0.0)
        begun = bool(c.program.read("doorInHand")) or bool(seen)
        if begun:
            seen.add(
                (c.io.read("doPathBusy"), c.io.read("doPathDone"), bool(c.read_signal("diSpindleStopped")))
            )

    def operator(dialog):
        coasts[0] = False
        robot.cell.set_input("diSpindleStopped", 1.0)
        return dialog.buttons[0][0]

    robot._on_time = watch
    robot.teach_pendant.operator = operator
    robot.run()
    assert [dialog.lines for dialog in robot.teach_pendant.dialogs] == [
        ("The spindle does not come to rest.", "Keep the clamp shut until it stands still.")
    ]
    assert robot.io.read("doPathDone") == 1
    assert (1, 0, False) in seen
    assert not any(not busy and not stands for busy, _, stands in seen)
    assert not any(done and not stands for _, done, stands in seen)


DRY = "Dry run in manual mode: no door is milled."


def test_a_dry_run_moves_the_whole_path_beside_an_open_guard_and_mills_nothing(cutting):
    robot = cutting(10**6, lambda c: None)
    turned: list[float] = []
    robot._on_time = lambda c: turned.append(c.read_signal("doSpindleOn"))
    robot.program.write("dryRun", "TRUE")
    robot.panel.set_mode(OperatingMode.MANUAL_REDUCED)
    robot.panel.motors(True)
    robot.panel.open_guard()
    robot.run()
    assert not any(turned)
    assert len(robot.moves) == robot.program.read("moveCount") + 1  # and home
    assert np.allclose(np.degrees(robot.q), HOME, atol=1e-3)
    assert [robot.io.read(s) for s in ("doPathFault", "doPathDone")] == [1, 0]
    assert (robot.home / signals.REFUSED_FILE).read_text() == f"1\n{DRY}\n"
    next_cycle(robot)
    assert [dialog.lines[0] for dialog in robot.teach_pendant.dialogs] == [DRY]


@pytest.mark.parametrize("motion", [1, 3])
def test_who_ends_the_dry_run_while_it_moves_starts_no_spindle(cutting, motion):
    """Its guard is not watched."""
    robot = cutting(motion, lambda c: c.program.write("dryRun", "FALSE"))
    turned: list[float] = []
    happens = robot._on_time

    def watch(c):
        happens(c)
        turned.append(c.read_signal("doSpindleOn"))

    robot._on_time = watch
    robot.program.write("dryRun", "TRUE")
    robot.panel.set_mode(OperatingMode.MANUAL_REDUCED)
    robot.panel.motors(True)
    robot.run()
    assert robot.happened
    assert not any(turned)
    assert len(robot.moves) == robot.program.read("moveCount") + 1  # and home
    assert (robot.home / signals.REFUSED_FILE).read_text() == f"1\n{DRY}\n"


def test_no_dry_run_in_automatic_mode(cutting):
    robot = cutting(10**6, lambda c: None)
    robot.program.write("dryRun", "TRUE")
    cuts = []
    robot._on_time = lambda c: cuts.append(c.context.cutting and c.moving)
    robot.run()
    assert not any(cuts)
    assert (robot.home / signals.REFUSED_FILE).read_text() == f"1\n{DRY}\n"


def test_the_door_that_ended_is_taken_out_before_another_is_asked_for(cutting):
    robot = cutting(3, lambda c: c.cell.set_input("diSpindleAtSpeed", 0.0))
    robot.run()
    robot.io.history.clear()
    opened = []

    def plant(c):
        if not opened:
            assert ("doPathRequest", 1) not in c.io.history
        if c.program.read("doorSpent") and not c.program.read("doorInHand"):
            opened.append(c.now())
        answer(c)

    robot._clock._pace = type(robot._clock._pace)(on_wait=lambda: plant(robot), patience=None)
    robot.run(reset=False)
    assert opened
    assert ("doPathRequest", 1) in robot.io.history
    assert "This run was milled before:" in robot.pendant_lines
