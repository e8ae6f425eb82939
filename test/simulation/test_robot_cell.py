"""The simulated cell's controller from door to door: what it keeps, and what it therefore refuses."""

from __future__ import annotations

import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.abb import signals
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.robot_cell import RobotCell, RobotCellRun
from support.faults.world import make_file
from support.waiting import LIMIT, until

DOOR = "door_a"


class Pc:
    """Answers one request with a file, as announced as the real PC does it."""

    def __init__(self, home: Path) -> None:
        self._home = home
        self._io = FolderIo(home)
        self.requests: list[str] = []

    def answer(self, run_id: str, data: bytes) -> None:
        until(lambda: self._io.read(signals.REQUEST) == 1)
        number = (self._home / signals.REQUEST_FILE).read_text().strip()
        self.requests.append(number)
        (self._home / signals.TARGET_FILE).write_bytes(data)
        (self._home / signals.ORDER_FILE).write_text(f"{run_id}\n{number}\n")
        self._io.write(signals.READY_NUMBER, int(number))
        self._io.write(signals.READY, 1)
        until(lambda: self._io.read(signals.REQUEST) == 0)
        self._io.write(signals.READY_NUMBER, 0)
        self._io.write(signals.READY, 0)


@pytest.fixture
def cell(tmp_path: Path) -> RobotCell:
    robot = load_robot("irb6600_175_255")
    return RobotCell(tmp_path, ControllerArm(robot.dh, robot.lower, robot.upper, robot.max_velocity))


def mill(cell: RobotCell, pc: Pc, run_id: str, data: bytes, door: str = DOOR) -> tuple[bool, RobotCellRun]:
    run = cell.start(door)
    answering = threading.Thread(target=pc.answer, args=(run_id, data), daemon=True)
    answering.start()
    milled = run.execute()
    answering.join(LIMIT)
    return milled, run


def test_the_robot_stands_where_the_cells_file_has_its_home(tmp_path: Path) -> None:
    robot = load_robot("irb6600_175_255")
    arm = ControllerArm(robot.dh, robot.lower, robot.upper, robot.max_velocity)
    drawn_back = np.array([0.1, -0.6, 0.5, 0.2, 0.3, -0.1])
    cell = RobotCell(tmp_path, arm, layout=replace(load_layout(), home=drawn_back))
    assert cell.controller.q.tolist() == drawn_back.tolist()
    cell.start(DOOR)
    assert cell.controller.q.tolist() == drawn_back.tolist()


def test_a_run_that_was_milled_is_refused_for_the_next_door_and_the_one_after(
    cell: RobotCell, tmp_path: Path
) -> None:
    pc = Pc(tmp_path)
    first, second = make_file(1, DOOR, "run-1"), make_file(2, DOOR, "run-2")
    assert mill(cell, pc, "run-1", first)[0]
    milled, run = mill(cell, pc, "run-1", first)
    assert not milled
    assert "This run was milled before:" in run.pendant_lines
    assert FolderIo(tmp_path).read(signals.FAULT) == 1
    assert mill(cell, pc, "run-2", second)[0]
    for run_id, data in (("run-1", first), ("run-2", second)):
        milled, run = mill(cell, pc, run_id, data)
        assert not milled
        assert run_id in run.pendant_lines
    # The number of the request is kept too: the PC tells each from the one before.
    assert pc.requests == ["1", "2", "3", "4", "5"]


def test_which_door_stands_in_the_cell_is_told_anew(cell: RobotCell, tmp_path: Path) -> None:
    pc = Pc(tmp_path)
    assert mill(cell, pc, "run-1", make_file(1, DOOR, "run-1"))[0]
    milled, run = mill(cell, pc, "run-2", make_file(1, DOOR, "run-2"), door="door_b")
    assert not milled
    assert "The target file is for another door:" in run.pendant_lines
    assert mill(cell, pc, "run-3", make_file(1, "door_b", "run-3"), door="door_b")[0]


def test_a_run_that_was_stopped_is_spent_as_well(cell: RobotCell, tmp_path: Path) -> None:
    pc, data = Pc(tmp_path), make_file(1, DOOR, "run-1")
    run = cell.start(DOOR)
    answering = threading.Thread(target=pc.answer, args=("run-1", data), daemon=True)
    answering.start()
    controller = run._controller
    controller._on_time = lambda c: c.motion_count and c.stop()
    assert not run.execute()
    answering.join(LIMIT)
    milled, run = mill(cell, pc, "run-1", data)
    assert not milled
    assert "This run was milled before:" in run.pendant_lines
