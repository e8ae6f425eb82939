"""A robot that mills a door by the project's modules, what happens to it in the cut, and its operator."""

from __future__ import annotations

import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.simulation.controller.rapid.errors import RapidStoppedError


@pytest.fixture
def cutting(door, controller):
    """A robot with the door's file, and what happens to it once while it cuts a given motion."""

    def cutting_(motion: int, happens, **kwargs):
        data = render_target_file(door("thesis_190_0deg"), "run-1")
        robot = controller(patience=None, **kwargs)
        (robot.home / signals.TARGET_FILE).write_bytes(data)
        done = []

        def watch(c):
            if not done and c.program.read("millingMotion") >= motion and c.moving and c.context.cutting:
                done.append(c.now())
                happens(c)

        robot._on_time = watch
        robot.teach_pendant.operator = lambda dialog: dialog.buttons[0][0]
        robot.happened = done
        return robot

    return cutting_


def next_cycle(robot) -> None:
    """Main begins anew and waits for the door to be taken out."""
    robot._on_time = lambda c: c.program.read("doorInHand") is False and c.stop()
    robot.clamped = 1.0
    with pytest.raises(RapidStoppedError, match="stopped from outside"):
        robot.run(reset=False)


def operator(robot) -> None:
    """Closes, releases, switches on and starts; nothing more."""
    state = robot.panel.state
    if not state.powered:
        robot.panel.restore_power()
    robot.panel.release_emergency_stop()
    robot.panel.close_guard()
    if not robot.panel.motors_on:
        robot.panel.motors(True)
    if not robot.panel.running:
        robot.panel.start()
