"""A shift: door after door in one run of the project's modules, with the real client and server of the web services.

One controller runs `main` in cycles. A plant clamps the doors in turn; every other one is named by the bar code
reader's way, through the PC, the rest by the number that a line control shows. The PC answers each request with the
file of the door that stands in the clamp. The judge compares the motions that the program ordered with the door's
path, and what the PC reported with what was milled.
"""

from __future__ import annotations

import gc
import os
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from doormill_ros.abb import signals
from doormill_ros.abb.credentials import Credentials
from doormill_ros.abb.errors import AbbError
from doormill_ros.abb.handshake.loop import HandshakeLoop
from doormill_ros.abb.handshake.sharing import SharedHandshake
from doormill_ros.abb.handshake.state import HandshakeSnapshot, HandshakeTimeouts
from doormill_ros.abb.handshake.state import HandshakeState as State
from doormill_ros.abb.target_file.target_file import check_handover, render_target_file
from doormill_ros.abb.transports.rws import connect_rws1
from doormill_ros.abb.transports.rws_http import LinkTimeouts
from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.simulation.controller.cabinet.cell import DOOR_CLAMPED
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.rapid.machine import Move
from doormill_ros.simulation.controller.rws_server.running import served_cabinet
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from doormill_ros.toolpath.generate import generate_program
from doormill_ros.toolpath.program import MillingProgram, MotionKind
from doormill_ros.units import m_to_mm, rad_to_deg
from support.waiting import LIMIT

ROBOT = "irb6600_175_255"
#: How far an ordered target may be from the door's own: half of the file's last decimal, and float32 [mm or deg].
CLOSE = 2e-3
#: So long that a loaded machine decides nothing; a bridge that starts waits as long for what another one sent before.
_LINK = LinkTimeouts(connect=20.0, read=20.0, write=20.0, total=20.0)
_WAITS = HandshakeTimeouts(submission=600.0, acknowledge=600.0, link_loss=600.0)
#: How long the plant waits for anything before the shift has failed [s].
#: Looks at the open handles, of which the least counts.
_LOOKS = 20


@dataclass(frozen=True)
class Resources:
    """What the process holds: memory [MB], open handles, threads."""

    memory: float
    handles: int
    threads: int

    @classmethod
    def now(cls) -> Resources:
        """As it is."""
        gc.collect()
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        memory = pages * os.sysconf("SC_PAGE_SIZE") / 1e6
        # The web services and the program open a signal's file for a moment now and then.
        handles = min(_handles_in(2e-3) for _ in range(_LOOKS))
        return cls(memory, handles, threading.active_count())


def _handles_in(pause: float) -> int:
    """Open handles after a pause [s]."""
    time.sleep(pause)
    return len(os.listdir("/proc/self/fd"))


@dataclass
class DoorReport:
    """What became of one door.

    Attributes:
        door: What stood in the clamp.
        run: Its run, empty when none was asked for.
        ordered: Motions that the program ordered towards it, until the next door comes.
        requests: Requests while it stood there.
        ends: What the PC reported of it, in order.
        held: Resources once it was out.
    """

    door: str
    run: str = ""
    ordered: list[Move] = field(default_factory=list)
    requests: int = 0
    ends: list[State] = field(default_factory=list)
    held: Resources | None = None


def ordered_place(move: Move) -> FloatArray:
    """Where a motion instruction leads: position [mm], or joint angles [deg]."""
    return np.array(move.target[0], dtype=float)


def wanted_places(program: MillingProgram) -> list[tuple[str, FloatArray]]:
    """Kind and place of each motion of a door's path, and the motion home behind it."""
    found = []
    for motion in program.motions:
        if motion.kind is MotionKind.ABSOLUTE:
            found.append((motion.kind.value, rad_to_deg(program.points[motion.target])))
        else:
            T_base_tool = program.targets[motion.target].T_base_tool_corrected
            found.append((motion.kind.value, m_to_mm(T_base_tool[:3, 3])))
    return [*found, (MotionKind.ABSOLUTE.value, rad_to_deg(np.array(load_layout().home)))]


def fault_of(report: DoorReport, program: MillingProgram) -> str:
    """What was wrong with a door, "" when nothing was."""
    wanted = wanted_places(program)
    if [move.kind for move in report.ordered] != [kind for kind, _ in wanted]:
        return f"{len(report.ordered)} motions were ordered, {len(wanted)} are the door's"
    for number, (move, (_, place)) in enumerate(zip(report.ordered, wanted, strict=True)):
        if np.abs(ordered_place(move) - place).max() > CLOSE:
            return f"motion {number} leads to {ordered_place(move)}, the door's to {place}"
    if report.requests != 1:
        return f"{report.requests} requests for one door"
    if report.ends != [State.DONE]:
        return f"the PC reported {[state.value for state in report.ends]}"
    return ""


class _WatchedController(VirtualController):
    """Tells every motion that the program orders."""

    told: Callable[[Move], None] = staticmethod(lambda _move: None)

    def move(self, move: Move) -> None:
        """Tell, then move."""
        self.told(move)
        super().move(move)


class Shift:
    """Doors one after the other over Robot Web Services 1.0."""

    def __init__(self, home: Path, doors: Sequence[str], count: int) -> None:
        """Prepare a shift of so many doors, of these kinds in turn."""
        robot, layout = load_robot(ROBOT), load_layout()
        self.programs = {}
        for name in dict.fromkeys(doors):
            recipe = load_recipe(name)
            T_base_door = layout.T_base_door(recipe.width, recipe.thickness, DoorOffset(0.0, 0.0, 0.0))
            self.programs[name] = generate_program(
                recipe, T_base_door, layout, robot, JointSpringModel(robot)
            )
        self._doors = [doors[i % len(doors)] for i in range(count)]
        self.reports: list[DoorReport] = []
        self.faults: list[str] = []
        self._ended = False
        self._io = FolderIo(home)
        self.controller = _WatchedController(
            home, ControllerArm(robot.dh, robot.lower, robot.upper, robot.max_velocity), io=self._io
        )
        self.controller.told = self._ordered
        self.controller.cell.set_input(DOOR_CLAMPED, 0.0)
        names = [*self.programs, *[""] * (32 - len(self.programs))]
        self.controller.program.write("doorNumbers", "[" + ",".join(f'"{n}"' for n in names) + "]")
        self._home = home

    def run(self, show: Callable[[int, DoorReport, str], None] = lambda *_: None) -> list[str]:
        """Mill all doors; gives what was wrong, a line a door."""
        self._show = show
        cabinet = served_cabinet(self._home, self._io, lambda: self.controller)
        with RwsServer(cabinet, 1) as server:
            link = connect_rws1(server.url, Credentials("Default User", "robotics"), timeouts=_LINK)
            self._handshake = SharedHandshake(
                link, timeouts=_WAITS, check=check_handover, on_change=self._changed
            )
            with HandshakeLoop(self._handshake):
                plant = threading.Thread(target=self._plant, name="plant")
                plant.start()
                self.controller.panel.start()
                try:
                    self.controller.serve()
                except AbbError as error:
                    self.faults.append(f"the program stopped: {error.message}")
                    self._ended = True
                plant.join()
        return self.faults

    # The PC

    def _changed(self, snapshot: HandshakeSnapshot) -> None:
        report = self.reports[-1] if self.reports else None
        if report is None:
            return
        report.requests += snapshot.state is State.REQUESTED
        # A state is entered anew when the controller was cleared in it: of the door before that says nothing new.
        ended = snapshot.state in (State.DONE, State.FAILED) and snapshot.run_id == report.run != ""
        if ended and report.ends[-1:] != [snapshot.state]:
            report.ends.append(snapshot.state)

    def _answer(self, report: DoorReport) -> None:
        now = self._handshake.snapshot
        if not now.accepts_submission or report.run:
            return
        report.run = f"run-{len(self.reports)}"
        data = render_target_file(self.programs[report.door], report.run)
        self._handshake.submit(report.run, report.door, data, now.request_number)

    # The plant

    def _plant(self) -> None:
        try:
            for number, door in enumerate(self._doors):
                report = DoorReport(door)
                if self.reports:
                    self.reports[-1].ordered.clear()
                self.reports.append(report)
                self._load(number, door)
                self._until(lambda r=report: State.DONE in r.ends or State.FAILED in r.ends, report)
                self._until(lambda: not self._io.read(signals.BUSY), report)
                self._clamp(0.0)
                self._until(lambda: not self.controller.program.read("doorSpent"), report)
                self.controller.recording.forget()
                report.held = Resources.now()
                fault = fault_of(report, self.programs[door])
                self.faults += [f"door {number}, {door}: {fault}"] if fault else []
                self._show(number, report, fault)
        except TimeoutError as error:
            self.faults.append(str(error))
        finally:
            self.controller.stop()

    def _load(self, number: int, door: str) -> None:
        """The door is named while it is being loaded: by its bar code, or by the line control."""
        while not self.controller.pendant_lines and not self._ended:
            time.sleep(0.005)  # a name from before the start is forgotten
        if number % 2:
            self.controller.cell.set_input("giDoorNumber", 1.0 + list(self.programs).index(door))
        else:
            self.controller.cell.set_input("giDoorNumber", 0.0)
            self._handshake.expect_door(door).result(LIMIT)
        self._clamp(1.0)

    def _clamp(self, closed: float) -> None:
        self.controller.cell.set_input(DOOR_CLAMPED, closed)

    def _until(self, reached: Callable[[], bool], report: DoorReport) -> None:
        end = time.monotonic() + LIMIT
        while not reached():
            if self._ended or time.monotonic() > end:
                raise TimeoutError(
                    f"door {len(self.reports) - 1}, {report.door}: {self._handshake.snapshot.reason}"
                )
            self._answer(report)
            time.sleep(0.005)

    def _ordered(self, move: Move) -> None:
        self.reports[-1].ordered.append(move)
