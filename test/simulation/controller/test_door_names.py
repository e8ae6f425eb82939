"""Who names the door that is loaded: the line control by a number, the PC by a file, the panel by its data."""

from __future__ import annotations

from pathlib import Path

import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.target_file.target_file import render_target_file

NAMES = ["door_one", "", "door_three"]


@pytest.fixture
def waiting(controller):
    """A robot with a door in the clamp that nobody has named; `plant` is asked as time passes."""

    def waiting_(plant):
        robot = controller(expected_door="", patience=None, on_wait=lambda c: plant(c))
        robot.program.write("doorNumbers", "[" + ",".join(f'"{n}"' for n in NAMES + [""] * 29) + "]")
        return robot

    return waiting_


def ended(robot, seconds: float) -> bool:
    """Ends the run when a path is asked for, or after so long."""
    if robot.io.read(signals.REQUEST) or robot.now() > seconds:
        robot.stop()
        return True
    return False


def name_of(robot) -> str:
    """What the robot took for the door's name when it asked for a path; empty when it never asked."""
    robot.panel.start()
    robot.serve()
    asked = ("doPathRequest", 1) in robot.io.history
    assert asked == bool(robot.program.read("expectedDoor"))
    return robot.program.read("expectedDoor")


def load_named(then):
    """The bar code of a door is read before it is clamped."""
    loaded: list[float] = []

    def plant(robot):
        if not loaded:
            loaded.append(robot.now())
            (robot.home / signals.EXPECTED_FILE).write_text(f"door_by_code\n{signals.EXPECTED_END}\n")
            robot.cell.set_input("diDoorClamped", 1.0)
        return then(robot)

    return plant


@pytest.mark.parametrize(
    ("number", "name"), [(1, "door_one"), (2, ""), (3, "door_three"), (0, ""), (4, ""), (33, ""), (255, "")]
)
def test_a_number_names_its_door_and_any_other_none(waiting, number, name):
    robot = waiting(lambda c: ended(c, 5.0))
    robot.cell.set_input("giDoorNumber", float(number))
    assert name_of(robot) == name


def test_a_number_counts_when_it_stays(waiting):
    """The bits of a group do not change together: on its way from 0 to 3 it may show 1 for a moment."""
    looks = []

    def plant(robot):
        looks.append(robot.now())
        # Another number at every look of the program, until it stays.
        step = int(robot.now() / 0.2)
        robot.cell.set_input("giDoorNumber", float((1, 2)[step % 2]) if robot.now() < 2.0 else 3.0)
        return ended(robot, 6.0)

    assert name_of(waiting(plant)) == "door_three"


def test_a_name_goes_before_a_number(waiting):
    robot = waiting(load_named(lambda c: ended(c, 5.0)))
    robot.cell.set_input("diDoorClamped", 0.0)
    robot.cell.set_input("giDoorNumber", 1.0)
    assert name_of(robot) == "door_by_code"
    assert not (robot.home / signals.EXPECTED_FILE).exists()


def test_a_door_that_leaves_takes_its_name_along(waiting):
    """Named, clamped, asked for, taken out: the next one is nameless."""
    robot = waiting(lambda c: None)
    robot.cell.set_input("giDoorNumber", 1.0)
    opened = []

    def plant(c):
        if c.io.read(signals.REQUEST) and not opened:
            opened.append(c.now())
            c.cell.set_input("giDoorNumber", 0.0)
            c.cell.set_input("diDoorClamped", 0.0)
        elif opened and c.now() > opened[0] + 1.0:
            c.cell.set_input("diDoorClamped", 1.0)
        if opened and c.now() > opened[0] + 5.0:
            c.stop()

    robot._clock._pace = type(robot._clock._pace)(on_wait=lambda: plant(robot), patience=None)
    robot.panel.start()
    robot.serve()
    assert robot.program.read("expectedDoor") == ""
    assert robot.io.history.count(("doPathRequest", 1)) == 1
    assert "Waiting for the name of the door." in robot.pendant_lines


def plant_of_two_doors(seen: list[str], opened: list[float]):
    """Mills the door that was named, whose bar code is read twice; then the clamp takes one that nobody names."""
    named: list[float] = []

    def plant(c):
        request = int(c.program.read("requestNumber")) if c.io.read(signals.REQUEST) else 0
        if not named:
            named.append(c.now())
            (c.home / signals.EXPECTED_FILE).write_text(f"thesis_190_0deg\n{signals.EXPECTED_END}\n")
        if not opened:
            if request and not seen:
                seen.append("read again")
                (c.home / signals.EXPECTED_FILE).write_text(f"thesis_190_0deg\n{signals.EXPECTED_END}\n")
            if c.program.read("doorSpent") and not c.program.read("doorInHand"):
                opened.append(c.now())
                c.cell.set_input("diDoorClamped", 0.0)
            if request and c.io.read(signals.READY_NUMBER) != request:
                (c.home / signals.ORDER_FILE).write_text(f"run-1\n{request}\n")
        elif c.now() > opened[0] + 2.0:
            c.cell.set_input("diDoorClamped", 1.0)
        answered = 0 if opened else request
        c.io.write(signals.READY_NUMBER, answered)
        c.io.write(signals.READY, int(bool(answered)))
        if opened and (request or c.now() > opened[0] + 10.0):
            c.stop()

    return plant


def test_a_bar_code_that_is_read_twice_names_one_door(controller, door):
    seen: list[str] = []
    opened: list[float] = []
    plant = plant_of_two_doors(seen, opened)
    robot = controller(expected_door="", patience=None, on_wait=lambda c: plant(c))
    (robot.home / signals.TARGET_FILE).write_bytes(render_target_file(door("thesis_190_0deg"), "run-1"))
    robot.cell.set_input("diDoorClamped", 1.0)
    robot.panel.start()
    robot.serve()
    assert (len(seen), len(opened)) == (1, 1)
    assert robot.io.read("doPathDone") == 1
    assert robot.io.history.count(("doPathRequest", 1)) == 1
    assert robot.program.read("expectedDoor") == ""


def test_a_name_that_cannot_be_taken_away_names_no_door(waiting, monkeypatch):
    """It would name every door after this one."""
    robot = waiting(load_named(lambda c: ended(c, 5.0)))
    robot.cell.set_input("diDoorClamped", 0.0)
    unlink = Path.unlink

    def held(path, *args, **kwargs):
        if path.name == signals.EXPECTED_FILE:
            raise PermissionError("in use")
        return unlink(path, *args, **kwargs)

    monkeypatch.setattr(Path, "unlink", held)
    assert name_of(robot) == ""


def exchange_while_it_stands(when):
    """Stops at a look of `when`; a door is loaded and named, then exchanged for one that nobody names."""
    stopped: list[float] = []

    def stop(c):
        if not stopped and when(c):
            stopped.append(c.now())
            c.panel.stop()
        if stopped and (c.io.read(signals.REQUEST) or c.now() > stopped[0] + 5.0):
            c.stop()

    def exchange(c):
        (c.home / signals.EXPECTED_FILE).write_text(f"door_a\n{signals.EXPECTED_END}\n")
        for clamped in (1.0, 0.0, 1.0):
            c.cell.set_input("diDoorClamped", clamped)
        c.panel.start()

    return stop, exchange, stopped


@pytest.mark.parametrize("clamped", [0.0, 1.0])
def test_a_name_that_is_read_while_the_program_stands_names_no_door(controller, clamped):
    """Stopped in the wait for a door, and in the wait for its name: nobody saw which door it was of."""
    asked = ("Waiting for a door in the clamp.", "Waiting for the name of the door.")[int(clamped)]
    stop, exchange, stopped = exchange_while_it_stands(lambda c: asked in c.pendant_lines)
    robot = controller(expected_door="", patience=None, on_wait=stop, on_stopped=exchange)
    robot.cell.set_input("diDoorClamped", clamped)
    robot.panel.start()
    robot.serve()
    assert stopped
    assert ("doPathRequest", 1) not in robot.io.history
    assert robot.program.read("expectedDoor") == ""
    assert not (robot.home / signals.EXPECTED_FILE).exists()


def test_a_name_that_the_panel_wrote_while_the_program_stood_names_no_door(controller):
    stop, exchange, stopped = exchange_while_it_stands(
        lambda c: "Waiting for the name of the door." in c.pendant_lines
    )

    def named(c):
        c.program.write("expectedDoor", '"door_a"')
        exchange(c)

    robot = controller(expected_door="", patience=None, on_wait=stop, on_stopped=named)
    robot.panel.start()
    robot.serve()
    assert stopped
    assert ("doPathRequest", 1) not in robot.io.history


def test_a_door_that_is_named_after_the_start_is_asked_for(controller):
    """The wait for a name goes on with the door that stands there now."""
    stop, exchange, stopped = exchange_while_it_stands(
        lambda c: "Waiting for the name of the door." in c.pendant_lines
    )

    def name(c):
        stop(c)
        if stopped and c.now() > stopped[0] + 2.0:
            (c.home / signals.EXPECTED_FILE).write_text(f"door_b\n{signals.EXPECTED_END}\n")

    robot = controller(expected_door="", patience=None, on_wait=name, on_stopped=exchange)
    assert name_of(robot) == "door_b"


@pytest.mark.parametrize("torn", [0, 6, 7, 8, 11])
def test_a_name_that_is_being_written_is_not_taken_for_another(waiting, torn):
    """It is written in place, while the program looks: of door_10 as much as door_1 may be there."""
    whole = f"door_10\n{signals.EXPECTED_END}\n"
    begun: list[float] = []

    def plant(robot):
        path = robot.home / signals.EXPECTED_FILE
        if not begun:
            begun.append(robot.now())
            path.write_text(whole[:torn])
        elif robot.now() > begun[0] + 3.0 and path.exists():
            path.write_text(whole)
        return ended(robot, 6.0)

    assert name_of(waiting(plant)) == "door_10"
