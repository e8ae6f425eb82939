"""Permission to open the clamp: given beside a robot that is home and a spindle at rest, and by nothing else."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from doormill_ros.resources import resource
from support.door_cutting import next_cycle, operator
from support.rapid_bench import answer

HOME = [0.0, -40.0, 30.0, 0.0, 10.0, 0.0]
FREE = "doClampFree"


def watched(robot) -> list[tuple[bool, bool]]:
    """Whether the clamp was free, and whether that was right, at every step of time."""
    seen: list[tuple[bool, bool]] = []
    before = robot._on_time

    def watch(c):
        home = np.abs(np.degrees(c.q) - HOME).max() < 1.0
        turns = c.read_signal("doSpindleRun") or not c.read_signal("diSpindleStopped")
        seen.append((bool(c.read_signal(FREE)), home and not turns))
        before(c)

    robot._on_time = watch
    return seen


def test_it_is_given_before_and_after_a_door_and_not_while_it_is_milled(cutting):
    robot = cutting(10**6, lambda c: None)
    seen = watched(robot)
    robot.run()
    free = [given for given, _ in seen]
    assert robot.io.read("doPathDone") == 1
    assert free[-1]
    assert any(free[: free.index(False, free.index(True))])
    assert not [None for given, right in seen if given and not right]
    changes = [b for a, b in pairwise(free) if a is not b]
    assert changes == [True, False, True]


@pytest.mark.parametrize("what", ["stop", "emergency_stop", "open_guard", "fail_power"])
def test_a_door_that_ended_is_held_until_the_robot_is_home(cutting, what):
    robot = cutting(3, lambda c: getattr(c.panel, what)(), on_stopped=operator)
    seen = watched(robot)
    robot.run()
    assert not seen[-1][0]
    robot._on_time = lambda c: None
    seen = watched(robot)
    robot._on_time, watch = None, robot._on_time

    def until_home(c):
        watch(c)
        if c.program.read("doorInHand") is False:
            c.stop()

    robot.program.write("doorSpent", "FALSE")
    robot._on_time = until_home
    with pytest.raises(Exception, match="stopped from outside"):
        robot.run(reset=False)
    assert seen[-1] == (True, True)
    assert not [None for given, right in seen if given and not right]


def test_a_robot_that_stands_may_be_jogged_so_it_is_taken_back_until_the_start(cutting):
    """Stopped while the door that was milled waits to be taken out."""
    stood: list[float] = []

    def plant(c):
        milled = c.io.read("doPathDone") == 1
        if milled and not stood:
            assert c.read_signal(FREE) == 1.0
            c.panel.stop()
            return
        if not milled or c.read_signal(FREE):
            answer(c)

    def stands(c):
        stood.append(c.read_signal(FREE))
        operator(c)

    robot = cutting(10**6, lambda c: None, on_wait=plant, on_stopped=stands)
    robot.run()
    assert stood
    assert not any(stood)
    assert robot.cell.read("diDoorClamped") == 0.0


def test_busy_is_told_again_when_the_outputs_fell_with_the_power(cutting, tmp_path):
    """On a controller that gives every output its default value when the power is back."""
    text = resource("rapid/EIO.cfg").read_text()
    name = '-Name "doPathBusy" -SignalType "DO"'
    assert name in text
    path = tmp_path / "EIO.cfg"
    path.write_text(text.replace(name, f'{name} -SafeLevel "SafetySafeLevel"'))
    robot = cutting(3, lambda c: c.panel.fail_power(), on_stopped=operator, io_configuration=path)
    robot.run()
    assert robot.io.read("doPathBusy") == 1
    # A restart of the program alone, with outputs that somebody lowered.
    robot.io.write("doPathBusy", 0)
    asked: list[int] = []

    def ask(dialog):
        asked.append(robot.io.read("doPathBusy"))
        return dialog.buttons[0][0]

    robot.teach_pendant.operator = ask
    next_cycle(robot)
    assert asked == [1, 0]
