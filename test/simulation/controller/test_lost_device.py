"""An I/O device that the controller loses: the door ends with a reason, and the robot is led home."""

from __future__ import annotations

import pytest

from doormill_ros.abb import signals
from support.door_cutting import next_cycle, operator

SPINDLE = (
    "doSpindleOn", "doSpindleRun", "aoSpindleSpeed", "doBlowOff", "doDrawbarOpen", "doDrawbarRun", "diSpindleAtSpeed",
    "diSpindleStopped", "diToolReleased", "diToolClamped",
)  # fmt: skip
OUTPUTS = tuple(name for name in SPINDLE if not name.startswith("di"))
TURNS = "The spindle does not come to rest."


def reason_of(robot) -> list[str]:
    return (robot.home / signals.REFUSED_FILE).read_text().splitlines()[1:]


def lose_outputs(robot) -> None:
    """The trap of the spindle comes, and switches off what it does not reach."""
    robot.cell.lose(*OUTPUTS)
    robot.cell.set_input("diSpindleAtSpeed", 0.0)


@pytest.mark.parametrize(
    ("happens", "reason"),
    [
        (lose_outputs, ["The spindle lost its speed."]),
        # No interrupt comes of it: the next motion finds it out, in main's ERROR clause.
        (lambda c: c.cell.lose(*SPINDLE), ["The program stopped with an error.", "ERRNO 1014"]),
    ],
)
def test_a_device_that_is_lost_in_the_cut_ends_the_door(cutting, happens, reason):
    robot = cutting(3, happens)
    robot.run()
    assert not robot.moving
    assert robot.read_signal("doPathFault") == 1.0
    assert robot.read_signal("doPathRequest") == 0.0
    assert robot.program.read("stopReason") != 0.0
    assert reason_of(robot) == reason
    robot.cell.lose()
    next_cycle(robot)
    assert robot.program.read("doorInHand") is False


def test_a_device_that_stays_away_leaves_the_robot_home_and_asks_before_the_clamp_is_opened(cutting):
    robot = cutting(3, lose_outputs)
    robot.run()
    robot.cell.lose(*SPINDLE)
    asked: list[str] = []

    def operator_(dialog):
        asked.append(dialog.lines[0])
        if asked[-1:] == [TURNS] and asked.count(TURNS) == 2:
            assert robot.read_signal("doPathBusy") == 1.0
            robot.cell.lose()
            robot.cell.set_input("diSpindleStopped", 1.0)
        return dialog.buttons[0][0]

    robot.teach_pendant.operator = operator_
    next_cycle(robot)
    assert asked.count(TURNS) == 2
    assert robot.read_signal("doPathBusy") == 0.0


def test_a_device_that_is_not_back_with_the_power_leaves_its_reason(cutting):
    robot = cutting(
        3, lambda c: c.panel.fail_power(), on_stopped=lambda c: (c.cell.lose(*SPINDLE), operator(c))
    )
    robot.run()
    assert robot.read_signal("doPathFault") == 1.0
    assert robot.program.read("stopReason") != 0.0
    assert not [entry for entry in robot.event_log if entry.title == "event routine"]
