"""Modules that were loaded anew know neither tool nor door: they ask, measure, and mill nothing that they find."""

from __future__ import annotations

import numpy as np
import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.simulation.controller.rapid.errors import RapidStoppedError
from support.rapid_bench import answer

OTHER_TOOL = ("Another tool is in the spindle.", "Put tool 1 in, the others into the rack.")
LENGTH = ("Tool 1: measure from the spindle's nose.", "How far does it stand out [mm]?")
OUT, MILLED = "Take the door out.", "Door is milled."
HOME = [0.0, -40.0, 30.0, 0.0, 10.0, 0.0]


def plant(robot) -> None:
    """A PC, somebody who exchanges doors, and a bar code reader."""
    answer(robot)
    if robot.pendant_lines and robot.pendant_lines[-1] == "Waiting for the name of the door.":
        (robot.home / signals.EXPECTED_FILE).write_text(f"thesis_190_0deg\n{signals.EXPECTED_END}\n")


@pytest.fixture
def made(door, controller):
    """A robot with the thesis door's file, and an operator who measures what he is asked for."""

    def made_(**kwargs):
        robot = controller(**{"on_wait": plant, **kwargs})
        file_of(robot, door("thesis_190_0deg"), "run-1")
        robot.teach_pendant.operator = lambda d: "120.2" if d.lines == LENGTH else d.buttons[0][0]
        return robot

    return made_


def file_of(robot, program, run: str) -> None:
    (robot.home / signals.TARGET_FILE).write_bytes(render_target_file(program, run))


def asked(robot) -> list[tuple[str, ...]]:
    return [dialog.lines for dialog in robot.teach_pendant.dialogs]


def test_modules_as_they_are_shipped_have_the_tool_measured_before_the_first_door(made):
    robot = made(commissioned=False)
    assert robot.program.read("toolMeasured") is False
    robot.run()
    assert asked(robot) == [OTHER_TOOL, LENGTH]
    assert robot.program.read("toolMill")[1][0][2] == pytest.approx(250.2, abs=1e-3)
    assert robot.pendant_lines[-1] == MILLED
    assert robot.pendant_lines.index(OUT) < robot.pendant_lines.index("Milling door:")


def test_after_reset_rapid_the_tool_is_measured_whatever_the_files_say(made, door):
    robot = made()
    robot.run()
    assert asked(robot) == []
    robot.reload()
    assert robot.program.read("toolMeasured") is True  # as it was saved
    file_of(robot, door("thesis_190_0deg"), "run-2")
    robot.run()
    assert asked(robot) == [OTHER_TOOL, LENGTH]
    assert robot.pendant_lines[-1] == MILLED
    assert robot.program.read("requestNumber") == 2


def test_modules_that_were_saved_and_loaded_before_any_request_ask_nothing(made):
    robot = made()
    robot.reload()
    robot.run()
    assert asked(robot) == []
    assert robot.pendant_lines[-1] == MILLED
    robot.run(reset=True)  # PP to main: its memory is up to date
    assert asked(robot) == []


def test_a_door_that_was_begun_is_not_asked_for_again_by_its_number(made):
    """The line control still shows its number, and the clamp still holds it."""
    robot = made(patience=None)
    robot.cell.spindle_works = False
    robot.run()
    assert robot.io.read("doPathFault") == 1
    robot.cell.spindle_works = True
    robot.reload()
    robot.program.write("doorNumbers", "[" + ",".join(['"thesis_190_0deg"'] + ['""'] * 31) + "]")
    robot.cell.set_input("giDoorNumber", 1.0)
    robot.io.history.clear()
    waited: list[float] = []

    def wait(c):
        waited.append(c.now())
        if c.now() > waited[0] + 60.0:
            c.stop()

    robot._clock._pace = type(robot._clock._pace)(on_wait=lambda: wait(robot), patience=None)
    with pytest.raises(RapidStoppedError):
        robot.run()
    assert ("doPathRequest", 1) not in robot.io.history
    assert robot.pendant_lines[-1] == OUT


def test_runs_that_were_begun_since_the_modules_were_saved_are_not_milled_again(made):
    robot = made()
    robot.run()
    robot.reload()
    robot.program.write("seenRuns", '["run-0"' + ',""' * 15 + "]")
    robot.program.write("seenNext", "2")
    robot.run()
    assert "This run was milled before:" in robot.pendant_lines


def test_a_way_home_that_was_saved_is_not_gone(made):
    """Nobody knows where the robot went since."""
    beside = np.radians([20.0, *HOME[1:]])
    robot = made()
    robot.run()
    robot._engine.q = robot._engine.planned_q = beside
    robot.reload()
    joints = ",".join(f"{angle:g}" for angle in np.degrees(beside))
    saved = {
        "doorInHand": "TRUE",
        "stopReason": "50",
        "escapeKnown": "TRUE",
        "escapeNext": "1",
        "stoppedKnown": "TRUE",
        "stoppedAt": f"[[{joints}],[9E9,9E9,9E9,9E9,9E9,9E9]]",
    }
    for name, literal in saved.items():
        robot.program.write(name, literal)
    moves = len(robot.moves)
    robot.run_to_question()
    assert asked(robot)[-1][1] == "Jog it clear of the door and run MoveHome."
    assert len(robot.moves) == moves
