"""The handshake against the RAPID modules themselves, and what they check of it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.handshake.handshake import Handshake
from doormill_ros.abb.handshake.state import HandshakeState as State
from doormill_ros.abb.link_errors import FileRefusedError
from doormill_ros.abb.target_file.target_file import check_handover
from doormill_ros.abb.transports.simulated_folder import SimulatedFolderTransport
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.rapid.errors import RapidStoppedError
from support.faults.world import make_file

DOOR = "door_a"


class Cell:
    """A robot program and a PC on one folder; the PC works whenever the program waits."""

    def __init__(self, home: Path, arm: ControllerArm) -> None:
        self.home = home
        self.io = FolderIo(home)
        self.link = SimulatedFolderTransport(home, timeout=60.0)
        self.states: list[State] = []
        self.handshake = Handshake(
            self.link, check=check_handover, on_change=lambda s: self.states.append(s.state)
        )
        self.handshake.on_start()
        self.runs = 0
        self.before_ready: Callable[[], None] = lambda: None
        self.after_ready: Callable[[], None] = lambda: None
        self.robot = VirtualController(
            home, arm, io=self.io, expected_door=DOOR, patience=5.0, on_wait=self._pc_works
        )

    def _pc_works(self, robot: VirtualController) -> None:
        self.handshake.step()
        self._exchange_doors(robot)
        if self.handshake.snapshot.accepts_submission and self.handshake.snapshot.state is State.REQUESTED:
            self.runs += 1
            run_id = f"run-{self.runs}"
            number = self.handshake.snapshot.request_number
            self.handshake.submit(run_id, DOOR, make_file(self.runs, DOOR, run_id), number)
            self.handshake.step()
            self.after_ready()

    def _exchange_doors(self, robot: VirtualController) -> None:
        """A door that was begun is taken out once the robot is not busy; the next one is clamped and named."""
        spent = robot.program.read("doorSpent")
        if self.io.read(signals.BUSY):
            return
        if not spent and not robot.cell.read("diDoorClamped"):
            robot.program.write("expectedDoor", f'"{DOOR}"')
        robot.cell.set_input("diDoorClamped", float(not spent))

    def mill(self, cycles: int = 1) -> None:
        if cycles == 1:
            self.robot.cell.set_input("diDoorClamped", 1.0)
            self.robot.name_door(DOOR)
        self.robot.run(cycles=cycles)
        for _ in range(4):
            self.handshake.step()

    @property
    def shown(self) -> str:
        return " ".join(self.robot.pendant_lines)


@pytest.fixture
def cell(tmp_path: Path, arm: ControllerArm):
    made = Cell(tmp_path, arm)
    yield made
    made.handshake.close()


def test_door_after_door(cell: Cell) -> None:
    for count in (1, 2, 3):
        cell.mill()
        assert cell.handshake.snapshot.state is State.DONE
        assert cell.handshake.outcome(f"run-{count}").handed_over
        assert cell.robot.program.read("runId") == f"run-{count}"
        assert cell.robot.program.read("requestNumber") == count
        assert (cell.home / signals.REQUEST_FILE).read_bytes() == f"{count}\n".encode()
        assert cell.io.read(signals.READY) == 0
        assert not (cell.home / signals.TARGET_FILE).exists()
        assert not (cell.home / signals.ORDER_FILE).exists()
    assert cell.states.count(State.READY) == 3
    assert State.FAILED not in cell.states


def test_seven_doors_in_one_continuous_run(cell: Cell) -> None:
    """A shift: the program is started once, nobody touches the pendant, and no door is asked for twice."""
    cell.mill(cycles=7)
    for count in range(1, 8):
        assert cell.handshake.outcome(f"run-{count}").handed_over
    assert cell.runs == 7
    assert cell.states.count(State.DONE) == 7
    assert State.FAILED not in cell.states
    assert cell.robot.program.read("requestNumber") == 7
    assert cell.robot.teach_pendant.dialogs == []
    assert cell.shown.count("Door is milled.") == 7


def test_a_late_upload_and_a_late_removal_of_the_order_are_refused(cell: Cell) -> None:
    """An earlier attempt's file lands, and an earlier clearing takes the order away."""
    late = make_file(40, DOOR, "earlier-attempt")

    def strike() -> None:
        (cell.home / signals.TARGET_FILE).write_bytes(late)
        (cell.home / signals.ORDER_FILE).unlink()

    cell.after_ready = strike
    cell.mill()
    assert cell.robot.motion_count == 0
    assert "No order was announced." in cell.shown
    assert cell.handshake.outcome("run-1").reason.endswith("No order was announced. earlier-attempt")


@pytest.mark.parametrize("number", [2, 65535])
def test_ready_for_another_request_is_no_answer(cell: Cell, number: int) -> None:
    cell.after_ready = lambda: cell.io.write(signals.READY_NUMBER, number)
    with pytest.raises(RapidStoppedError):
        cell.mill()
    assert cell.robot.motion_count == 0


def test_done_stays_until_the_next_request(cell: Cell) -> None:
    cell.mill()
    assert cell.io.read(signals.DONE) == 1
    seen: list[int] = []
    cell.after_ready = lambda: seen.append(cell.io.read(signals.DONE))
    cell.mill()
    assert seen == [0]
    assert cell.io.read(signals.DONE) == 1


@pytest.mark.parametrize(
    "order", ["run-9\n1\n", "run-1\n2\n", "run-1\n", "", "run-1\n1x\n", "1\nrun-1\n", "run-1 \n1\n"]
)
def test_a_file_that_was_not_announced_is_refused(cell: Cell, order: str) -> None:
    """An earlier upload that arrives late, or an answer to an earlier request."""
    cell.after_ready = lambda: (cell.home / signals.ORDER_FILE).write_text(order)
    cell.mill()
    assert cell.robot.motion_count == 0
    assert "Another run or request is announced:" in cell.shown
    outcome = cell.handshake.outcome("run-1")
    assert not outcome.handed_over
    assert outcome.error_code == FileRefusedError.code


def test_a_complete_file_that_lands_late_is_refused(cell: Cell) -> None:
    late = make_file(40, DOOR, "earlier-attempt")
    cell.after_ready = lambda: (cell.home / signals.TARGET_FILE).write_bytes(late)
    cell.mill()
    assert cell.robot.motion_count == 0
    assert "Another run or request is announced:" in cell.shown


def test_ready_that_falls_while_the_file_is_read_is_a_refusal(cell: Cell) -> None:
    read, fallen = cell.robot.read_signal, []

    def fall_after_the_first_look(name: str) -> float:
        level = read(name)
        if name == signals.READY_NUMBER and level and not fallen:
            fallen.append(True)
            cell.io.write(signals.READY_NUMBER, 0)
        return level

    cell.robot.read_signal = fall_after_the_first_look
    cell.mill()
    assert fallen
    assert cell.robot.motion_count == 0
    assert "The PC took the target file back." in cell.shown


def test_the_request_number_outlives_the_program(cell: Cell) -> None:
    cell.robot.program.write("requestNumber", "65534")
    (cell.home / signals.REQUEST_FILE).write_text("65534\n")
    for expected in (65535, 1, 2):
        cell.mill()
        assert cell.robot.program.read("requestNumber") == expected
        assert cell.handshake.snapshot.state is State.DONE
