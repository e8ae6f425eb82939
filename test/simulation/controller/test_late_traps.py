"""The trap of going on after a stop comes late: what the program does until then changes nothing."""

from __future__ import annotations

import pytest

from support.door_cutting import next_cycle, operator

FEATURE = 5


def stop_when(robot, condition) -> list[float]:
    """Stops the program once when a condition holds, and ends the simulation when nothing comes of it."""
    stopped: list[float] = []

    def watch(c):
        if not stopped and c.moving and condition(c):
            stopped.append(c.now())
            c.panel.stop()
        if stopped and c.now() > stopped[0] + 120.0:
            c.stop()

    robot._on_time = watch
    return stopped


@pytest.fixture(params=[False, True], ids=["RESTART first", "regain first"])
def any_order(request):
    """Lets a robot do what controllers may do in another order."""

    def any_order_(robot):
        robot.execution.regains_first = request.param
        return robot

    return any_order_


@pytest.mark.parametrize("what", ["stop", "emergency_stop", "fail_power"])
def test_a_stop_in_the_cut_ends_the_door(cutting, any_order, what):
    robot = any_order(cutting(6, lambda c: getattr(c.panel, what)(), on_stopped=operator))
    robot.run()
    assert robot.happened
    assert robot.read_signal("doSpindleOn") == 0.0
    assert robot.program.read("stopReason") != 0
    ordered = len(robot.moves)
    next_cycle(robot)
    assert robot.moves[ordered].kind in ("MoveL", "MoveC")
    assert [robot.io.read(name) for name in ("doPathFault", "doPathDone")] == [1, 0]


@pytest.mark.parametrize("last_of_all", [False, True])
def test_the_way_home_is_that_of_the_motion_that_was_stopped(cutting, any_order, last_of_all):
    """The last one at a feature: the next one is of another feature, or leads home."""
    robot = any_order(cutting(10**6, lambda c: None, on_stopped=operator))

    def last_at_feature(c):
        number = int(c.program.read("millingMotion"))
        if number < 2 or c.executed_motion != number - 1:
            return False
        moves, last = c.program.read("moves"), number == c.program.read("moveCount")
        feature = moves[number - 1][FEATURE]
        if feature == 0 or last is not last_of_all or feature == moves[number][FEATURE]:
            return False
        way[:] = [c.program.read(name) for name in ("escapeNext", "pathFirst")]
        return True

    way: list[float] = []
    stopped = stop_when(robot, last_at_feature)
    robot.run()
    assert stopped
    assert robot.program.read("stopReason") != 0
    assert [robot.program.read(name) for name in ("escapeNext", "pathFirst")] == way
    assert way[1] != 0


def test_a_point_on_the_way_home_is_gone_to_again(cutting, any_order):
    robot = any_order(cutting(3, lambda c: c.cell.set_input("diDoorClamped", 0.0), on_stopped=operator))
    robot.run()
    goals: list[list[float]] = []
    at: list[int] = []

    def on_the_way(c):
        return c.program.read("escapeNext") == 1 and robot.moves[-1].kind == "MoveAbsJ"

    stopped = stop_when(robot, on_the_way)
    watch = robot._on_time

    def watched(c):
        watch(c)
        if stopped and not at:
            at.append(len(robot.moves))
            goals.append(robot.moves[-1].target[0])
        if c.program.read("doorInHand") is False:
            c.stop()

    robot._on_time = watched
    asked: list[int] = []

    def retract(dialog):
        asked.append(len(robot.moves))
        return dialog.buttons[0][0]

    robot.teach_pendant.operator = retract
    with pytest.raises(Exception, match="stopped from outside"):
        robot.run(cycles=3, reset=False)
    assert stopped
    again = next(number for number in asked if number >= at[0])
    assert robot.moves[again].target[0] == goals[0]
