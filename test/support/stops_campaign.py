"""Seeded stops of a milling robot, an operator who follows the pendant, and a judge who sees only the motion.

One run: two doors, one after the other, on the modules in rapid/ and the virtual controller. While the first door is
milled something happens: a stop, an emergency stop, an open guard, a loss of power, of the spindle or of the clamp.
The operator closes the guard, switches the motors on, answers dialogs by one of their buttons, presses start, and now
and then moves the pointer to main first. He knows nothing else. The judge looks at the tool, the spindle and the guard:

- no feed into uncut wood with a spindle below its speed,
- no spindle that is told to turn while the guard is open, and no motion then,
- no door reported as done that is not milled, and the second door is milled completely.
"""

from __future__ import annotations

import random
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from doormill_ros.abb import signals
from doormill_ros.abb.errors import AbbError
from doormill_ros.abb.handshake.handshake import Handshake
from doormill_ros.abb.handshake.state import HandshakeState as State
from doormill_ros.abb.target_file.target_file import check_handover, render_target_file
from doormill_ros.abb.transports.simulated_folder import SimulatedFolderTransport
from doormill_ros.arrays import FloatArray
from doormill_ros.cell.layout import DoorOffset, load_layout
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.simulation.controller.arm import ControllerArm
from doormill_ros.simulation.controller.cell import DOOR_CLAMPED, SPINDLE_AT_SPEED
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.io_port import FolderIo
from doormill_ros.simulation.controller.limits import ControllerLimits
from doormill_ros.simulation.controller.operation.panel import ControlPanel
from doormill_ros.simulation.controller.operation.states import ControllerState, OperatingMode, StopMode
from doormill_ros.simulation.controller.rapid.errors import OrderRefusedError
from doormill_ros.toolpath.generate import generate_program
from doormill_ros.toolpath.program import MillingProgram

DOOR = "thesis_190_0deg"
ROBOT = "irb6600_175_255"
KINDS = (
    "program stop", "quick stop", "stop after instruction", "emergency stop 0", "emergency stop 1", "guard",
    "power failure", "motors off", "mode change", "spindle loss", "clamp loss",
)  # fmt: skip
#: Edge of the cells in which wood is counted [m].
CELL = 1e-3
#: A spindle below this share of its speed does not cut; at-speed falls there.
AT_SPEED = 0.9
#: After the spindle fell below its speed a stop may take so long, after the guard opened likewise [s].
REACTION, GUARD_REACTION = 0.3, 0.6
#: When a run has not come to its end [s of simulated time].
LIMIT = 300.0
#: How often PC, plant and operator act [s].
PC_STEP, OPERATOR_STEP = 0.1, 0.5


@dataclass(frozen=True)
class Incident:
    """What happens in a run: its kind, and when since the first door's file was accepted [s]."""

    seed: int
    kind: str
    delay: float


@dataclass
class Verdict:
    """What the judge saw.

    Attributes:
        feeds: Times of feeds into wood with a spindle below its speed [s].
        turning: Times at which the spindle was told to turn with an open guard [s].
        moving: Times of motions with an open guard [s].
        struck: The incident happened.
        done_unmilled: A door was reported as done that was not.
        recovered: The second door was milled completely and reported as done.
        remarks: What else there is to say.
    """

    feeds: list[float] = field(default_factory=list)
    turning: list[float] = field(default_factory=list)
    moving: list[float] = field(default_factory=list)
    struck: bool = False
    done_unmilled: bool = False
    recovered: bool = False
    remarks: list[str] = field(default_factory=list)

    @property
    def safe(self) -> bool:
        """Nothing was broken and nobody hurt."""
        return not (self.feeds or self.turning or self.moving)

    @property
    def passed(self) -> bool:
        """Safe, and the work went on."""
        return self.safe and self.recovered and not self.done_unmilled and self.struck


def draw(seed: int) -> Incident:
    """The incident of a seed."""
    chance = random.Random(f"stops/{seed}")
    return Incident(seed, KINDS[seed % len(KINDS)], chance.uniform(0.0, milling_time()))


@cache
def door_program() -> MillingProgram:
    """What is milled: the same on every door."""
    layout, robot, recipe = load_layout(), load_robot(ROBOT), load_recipe(DOOR)
    T_base_door = layout.T_base_door(recipe.width, recipe.thickness, DoorOffset(0.0, 0.0, 0.0))
    return generate_program(recipe, T_base_door, layout, robot, JointSpringModel(robot))


@cache
def milling_time() -> float:
    """How long milling takes by its programmed speeds alone [s]."""
    program = door_program()
    points = np.array([t.T_base_tool_corrected[:3, 3] for t in program.targets])
    ways = np.linalg.norm(np.diff(points[[m.target for m in program.motions]], axis=0), axis=1)
    return float(sum(w / m.speed for w, m in zip(ways, program.motions[1:], strict=True)))


def _cell(point: FloatArray) -> tuple[int, int, int]:
    x, y, z = np.floor(point / CELL).astype(int)
    return int(x), int(y), int(z)


_AROUND = [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]


def _grown(cells: Iterable[tuple[int, int, int]]) -> set[tuple[int, int, int]]:
    """The cells and their neighbours."""
    return {(x + i, y + j, z + k) for x, y, z in cells for i, j, k in _AROUND}


@cache
def wood() -> frozenset[tuple[int, int, int]]:
    """Cells through which the tool centre point cuts when nothing stops it, from an undisturbed run."""
    cell = Run(Incident(0, "nothing", 0.0), doors=1)
    cell.mill()
    path = cell.robot.executed_path()
    cut = path.cutting & path.at_speed
    return frozenset(_cell(point) for point in path.T_base_tool_commanded[cut, :3, 3])


class Judge:
    """Watches tool, spindle and guard."""

    def __init__(self, robot: VirtualController, verdict: Verdict, known: bool) -> None:
        """Judge into a verdict; `known` tells whether it is known where the wood is."""
        self._robot, self._verdict = robot, verdict
        self._wood = _grown(wood()) if known else set()
        self._seen, self._time, self._share = 0, 0.0, 0.0
        self._slow_since: float | None = 0.0
        self._open_since: float | None = None
        self.cut: set[tuple[int, int, int]] = set()

    def new_door(self) -> None:
        """Another door stands there: all of its wood is uncut."""
        self.cut.clear()

    def complete(self) -> bool:
        """Whether all that should be milled of the present door is."""
        return wood() <= _grown(self.cut)

    def watch(self) -> None:
        """Look at what has happened since the last look."""
        robot, now = self._robot, self._robot.now()
        cell = robot.cell
        told = cell.read(cell.spindle_drive) == 1.0
        step, self._time = now - self._time, now
        change = step / cell.spindle_time
        self._share = float(
            np.clip(self._share + (change if told and cell.spindle_works else -change), 0.0, 1.0)
        )
        if self._share >= AT_SPEED:
            self._slow_since = None
        elif self._slow_since is None:
            self._slow_since = now
        self._look_at_the_guard(now, told)
        recording = robot.recording
        for i in range(self._seen, len(recording.time)):
            driven = recording.driven[i]
            moved = i > 0 and np.abs(recording.q[i] - recording.q[i - 1]).max() > 1e-7
            self._look_at_the_tool(recording.time[i], recording.poses[i][:3, 3], moved and driven)
        self._seen = len(recording.time)

    def _look_at_the_guard(self, now: float, told: bool) -> None:
        if self._robot.panel.guard_closed:
            self._open_since = None
            return
        if self._open_since is None:
            self._open_since = now
        if now - self._open_since <= GUARD_REACTION:
            return
        if told:
            self._verdict.turning.append(now)
        manual = self._robot.panel.state.mode is not OperatingMode.AUTO
        if self._robot.moving and not manual:
            self._verdict.moving.append(now)

    def _look_at_the_tool(self, time: float, point: FloatArray, feeding: bool) -> None:
        place = _cell(point)
        if self._share > 0.3:
            self.cut.add(place)
            return
        slow = self._slow_since is not None and time - self._slow_since > REACTION
        if feeding and slow and place in self._wood and not _grown([place]) & self.cut:
            self._verdict.feeds.append(time)


class Operator:
    """Brings the robot back to work by what the pendant shows."""

    def __init__(self, robot: VirtualController, chance: random.Random) -> None:
        """Work at a robot; `chance` is his mood."""
        self._robot, self._chance = robot, chance
        self._patience = chance.uniform(2.0, 8.0)
        self._stopped_since: float | None = None
        self.answers: list[str] = []

    def act(self) -> None:
        """One look, and one action at most."""
        panel, now = self._robot.panel, self._robot.now()
        state = panel.state
        self._answer()
        if panel.running:
            self._stopped_since = None
            return
        if self._stopped_since is None:
            self._stopped_since = now
        if now - self._stopped_since < self._patience:
            return
        try:
            if not state.powered:
                panel.restore_power()
            elif not panel.guard_closed:
                panel.close_guard()
            elif state.controller is ControllerState.EMERGENCY_STOP:
                panel.release_emergency_stop()
            elif state.mode is not OperatingMode.AUTO:
                panel.set_mode(OperatingMode.AUTO)
            elif state.controller is not ControllerState.MOTORS_ON:
                panel.motors(True)
            else:
                if state.pointer_lost or self._chance.random() < 0.2 or self._too_far():
                    panel.pointer_to_main()
                panel.start()
        except OrderRefusedError as error:
            self.answers.append(error.message)

    def _too_far(self) -> bool:
        log = self._robot.event_log
        return bool(log) and log[-1].title == "regain" and log[-1].kind == "error"

    def _answer(self) -> None:
        pendant = self._robot.teach_pendant
        dialog = pendant.dialog
        if dialog is None:
            return
        choices = [text for text, _ in dialog.buttons] or list(dialog.items)
        if choices:
            choice = self._chance.choice(choices)
            self.answers.append(f"{dialog.header}: {choice}")
            pendant.press(choice)


class Run:
    """Two doors, an incident, and everybody who takes part."""

    def __init__(self, incident: Incident, doors: int = 2, limits: ControllerLimits | None = None) -> None:
        """Set the cell up in a folder of its own."""
        self._folder = tempfile.TemporaryDirectory(prefix="stops-")
        home = Path(self._folder.name)
        robot = load_robot(ROBOT)
        self._incident, self._doors, self._placed, self._runs = incident, doors, 1, 0
        self.verdict = Verdict()
        self.robot = VirtualController(
            home,
            ControllerArm(robot.dh, robot.lower, robot.upper, robot.max_velocity),
            io=FolderIo(home),
            limits=limits,
            expected_door=DOOR,
            on_wait=lambda _: None,
            on_stopped=lambda _: None,
            on_time=lambda _: self._watch(),
        )
        self._judge = Judge(self.robot, self.verdict, known=doors > 1)
        self._operator = Operator(self.robot, random.Random(f"operator/{incident.seed}"))
        self._handshake = Handshake(
            SimulatedFolderTransport(home, timeout=60.0), clock=self.robot.now, check=check_handover
        )
        self._handshake.on_start()
        self._acted = self._worked = 0.0
        self._struck = False
        self._begun: float | None = None
        self._ended_since: float | None = None
        self._swap: float | None = None

    def mill(self) -> Verdict:
        """Mill until the last door is done, or until it takes too long."""
        try:
            self.robot.panel.start()
            self.robot.serve()
        except AbbError as error:
            self.verdict.remarks.append(error.message)
        finally:
            self._handshake.close()
            self._folder.cleanup()
        state = self.robot.panel.state
        self.verdict.remarks.append(f"{state.execution} after {self.robot.now():.0f} s: {state.detail}")
        return self.verdict

    def _watch(self) -> None:
        """Everybody's turn as time passes."""
        now = self.robot.now()
        self._judge.watch()
        if now > LIMIT:
            self.robot.stop()
        if now - self._worked >= PC_STEP:
            self._worked = now
            self._work()
            self._strike(now)
            self._serve_doors(now)
        if now - self._acted >= OPERATOR_STEP:
            self._acted = now
            self._operator.act()

    def _work(self) -> None:
        """The PC: a file for each request."""
        if not self.robot.panel.state.powered:
            return
        self._handshake.step()
        now = self._handshake.snapshot
        if now.accepts_submission and now.state is State.REQUESTED:
            self._runs += 1
            run_id = f"run-{self._runs}"
            data = render_target_file(door_program(), run_id)
            self._handshake.submit(run_id, DOOR, data, now.request_number)
            self._handshake.step()

    def _strike(self, now: float) -> None:
        """Let the incident happen."""
        if self._begun is None and self.robot.context.index >= 0:
            self._begun = now
        if self._begun is None or self._struck or self._incident.kind == "nothing":
            return
        if now >= self._begun + self._incident.delay and self.robot.panel.running:
            self._struck = self.verdict.struck = True
            ACTIONS[self._incident.kind](self.robot.panel, self.robot)

    def _serve_doors(self, now: float) -> None:
        """The plant: takes a door out that is done or failed, and clamps the next one."""
        cell, io = self.robot.cell, self.robot.io
        if not cell.spindle_works and not self.robot.panel.running:
            cell.spindle_works = True
        if self._swap is not None:
            if now >= self._swap:
                self._swap = None
                self._placed += 1
                self._judge.new_door()
                if self.robot.program.has_data("expectedDoor"):
                    self.robot.program.write("expectedDoor", f'"{DOOR}"')
                cell.set_input(DOOR_CLAMPED, 1.0)
            return
        if self._doors == 1 and self._begun is not None and self.robot.context.index < 0:
            self.robot.stop()  # on its way home
        done, fault = io.read(signals.DONE) == 1, io.read(signals.FAULT) == 1
        if not (done or fault) or io.read(signals.BUSY) or self.robot.moving:
            self._ended_since = None
            return
        if self._ended_since is None:
            self._ended_since = now
            if done and self._doors > 1 and not self._judge.complete():
                self.verdict.done_unmilled = True
        if now - self._ended_since < 1.0:
            return
        if done and self._placed >= self._doors > 1:
            self.verdict.recovered = self._judge.complete()
            self.robot.stop()
        cell.spindle_works = True
        cell.set_input(DOOR_CLAMPED, 0.0)
        self._swap = now + 5.0


def _lose_spindle(_panel: ControlPanel, robot: VirtualController) -> None:
    robot.cell.spindle_works = False
    robot.cell.set_input(SPINDLE_AT_SPEED, 0.0)


ACTIONS: dict[str, Callable[[ControlPanel, VirtualController], None]] = {
    "program stop": lambda panel, _: panel.stop(),
    "quick stop": lambda panel, _: panel.stop(StopMode.QUICK),
    "stop after instruction": lambda panel, _: panel.stop(StopMode.INSTRUCTION),
    "emergency stop 0": lambda panel, _: panel.emergency_stop(0),
    "emergency stop 1": lambda panel, _: panel.emergency_stop(1),
    "guard": lambda panel, _: panel.open_guard(),
    "power failure": lambda panel, _: panel.fail_power(),
    "motors off": lambda panel, _: panel.motors(False),
    "mode change": lambda panel, _: panel.set_mode(OperatingMode.MANUAL_REDUCED),
    "spindle loss": _lose_spindle,
    "clamp loss": lambda _, robot: robot.cell.set_input(DOOR_CLAMPED, 0.0),
}


def campaign(runs: int, seed: int) -> list[tuple[Incident, Verdict]]:
    """So many runs from a seed on."""
    return [(incident, Run(incident).mill()) for incident in map(draw, range(seed, seed + runs))]
