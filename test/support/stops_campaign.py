"""Seeded stops of a milling robot, an operator who follows the pendant, and a judge who sees only the motion.

One run: two doors, one after the other, on the modules in rapid/ and the virtual controller. While the first door is
milled something happens: a stop, an emergency stop, an open guard, a loss of power, of the spindle or of the clamp; or
the door is exchanged for another while the robot stands, from its request on, or before it, once its name was read.
The operator closes the guard, switches the motors on, answers dialogs by one of their buttons, names a door where he is
asked to, presses start, and now and then moves the pointer to main first. He knows nothing else. `stops_judge` judges;
besides, no door is reported as done that is not milled, and the last door is milled completely.
"""

from __future__ import annotations

import random
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
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
from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.resources import resource
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.simulation.controller.cabinet.cell import DOOR_CLAMPED, SPINDLE_AT_SPEED
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo
from doormill_ros.simulation.controller.configuration.installed import read_installed
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.motions.limits import ControllerLimits
from doormill_ros.simulation.controller.operation.panel import ControlPanel
from doormill_ros.simulation.controller.operation.states import ControllerState, OperatingMode, StopMode
from doormill_ros.simulation.controller.rapid.errors import OrderRefusedError
from doormill_ros.toolpath.generate import generate_program
from doormill_ros.toolpath.program import MillingProgram, MotionKind
from support.stops_judge import Judge, Verdict, Wood, cell_of

#: Shallow pockets in one pass, and deep ones in several levels with rings.
SHALLOW, DEEP = "thesis_190_0deg", "nine_point_door"
ROBOT = "irb6600_175_255"
KINDS = (
    "program stop", "quick stop", "stop after instruction", "emergency stop 0", "emergency stop 1", "guard",
    "power failure", "motors off", "mode change", "spindle loss", "clamp loss",
    "exchange at a stop", "exchange without power", "named at a stop", "named without power",
)  # fmt: skip
#: The first door of a run whose door is named behind the program's back is loaded, then named [s].
LOADED, NAMED = 1.5, 3.0
#: How long after the stop that door is clamped and named, the clamp opens, and closes on the other door [s].
NAMED_EXCHANGE = 0.2, 0.4, 0.6, 1.2
#: From the request until the tool has begun to cut, about [s].
PREPARATION = 5.0
#: From the picture of a door until its file is there [s].
THINKING = 3.0
#: How long after the stop the clamp opens, and closes on the other door [s].
EXCHANGE = 0.6, 1.2
#: When a run has not come to its end [s of simulated time].
LIMIT = 300.0
#: How often PC, plant and operator act [s].
PC_STEP, OPERATOR_STEP = 0.1, 0.5


@dataclass(frozen=True)
class Incident:
    """What happens in a run.

    Attributes:
        seed: Of the run.
        kind: One of KINDS.
        delay: When, since the first door's first motion, of an exchange since its request, of one that is named
            since the start [s].
        door: What is milled.
    """

    seed: int
    kind: str
    delay: float
    door: str = SHALLOW


def draw(seed: int) -> Incident:
    """The incident of a seed."""
    chance = random.Random(f"stops/{seed}")
    kind, door = KINDS[seed % len(KINDS)], DEEP if seed % 5 == 4 else SHALLOW
    longest = PREPARATION if "exchange" in kind or "named" in kind else milling_time(door)
    return Incident(seed, kind, chance.uniform(0.0, longest), door)


def _place(door: str) -> tuple[Recipe, FloatArray]:
    """The recipe and T_base_door, shape (4, 4)."""
    recipe = load_recipe(door)
    return recipe, load_layout().T_base_door(recipe.width, recipe.thickness, DoorOffset(0.0, 0.0, 0.0))


@cache
def door_program(door: str) -> MillingProgram:
    """What is milled into every door of a run."""
    recipe, T_base_door = _place(door)
    robot = load_robot(ROBOT)
    return generate_program(recipe, T_base_door, load_layout(), robot, JointSpringModel(robot))


@cache
def milling_time(door: str) -> float:
    """How long milling takes by its programmed speeds alone [s]."""
    program = door_program(door)
    points = np.array([t.T_base_tool_corrected[:3, 3] for t in program.targets])
    motions = [m for m in program.motions if m.kind is not MotionKind.ABSOLUTE]
    ways = np.linalg.norm(np.diff(points[[m.target for m in motions]], axis=0), axis=1)
    return float(sum(w / m.speed for w, m in zip(ways, motions[1:], strict=True)))


@cache
def wood_of(door: str) -> Wood:
    """The wood of a door; what is cut of it comes from an undisturbed run."""
    recipe, T_base_door = _place(door)
    size = np.array([recipe.thickness, recipe.width, recipe.size.height])
    uncut = Wood(T_base_door, size)
    cell = Run(Incident(0, "nothing", 0.0, door), doors=1, wood=uncut)
    cell.mill()
    path = cell.robot.executed_path()
    cut = path.cutting & path.at_speed
    return Wood(T_base_door, size, frozenset(cell_of(p) for p in path.T_base_tool_commanded[cut, :3, 3]))


class Operator:
    """Brings the robot back to work by what the pendant shows."""

    def __init__(
        self, robot: VirtualController, chance: random.Random, name_door: Callable[[], None]
    ) -> None:
        """Work at a robot; `chance` is his mood, `name_door` his bar code reader."""
        self._robot, self._chance, self._name_door = robot, chance, name_door
        self._read = 0
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
            lines = self._robot.pendant_lines
            if "Waiting for the name of the door." in lines[self._read :]:
                self._name_door()
            self._read = len(lines)
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

    def __init__(
        self,
        incident: Incident,
        doors: int = 2,
        limits: ControllerLimits | None = None,
        wood: Wood | None = None,
        modules: Sequence[Path] | None = None,
    ) -> None:
        """Set the cell up in a folder of its own.

        Args:
            incident: What happens.
            doors: How many doors are milled.
            limits: Of the controller; None for config/controller.yaml.
            wood: Of the door; None for `wood_of` its name.
            modules: Instead of those in rapid/, as its SYS.cfg needs them.
        """
        self._folder = tempfile.TemporaryDirectory(prefix="stops-")
        home = self._home = Path(self._folder.name)
        robot = load_robot(ROBOT)
        self._incident, self._doors, self._placed, self._runs = incident, doors, 1, 0
        self.verdict = Verdict()
        self.robot = VirtualController(
            home,
            ControllerArm(robot.dh, robot.lower, robot.upper, robot.max_velocity),
            io=FolderIo(home),
            limits=limits,
            installed=read_installed(modules, system_parameters=resource("rapid/SYS.cfg")),
            expected_door=incident.door,
            on_wait=lambda _: None,
            on_stopped=lambda _: None,
            on_time=lambda _: self._watch(),
        )
        wood = wood or wood_of(incident.door)
        self._judge = Judge(self.robot, self.verdict, wood, self._accepted)
        chance = random.Random(f"operator/{incident.seed}")
        self._operator = Operator(self.robot, chance, self._name_door)
        self._handshake = Handshake(
            SimulatedFolderTransport(home, timeout=60.0), clock=self.robot.now, check=check_handover
        )
        self._handshake.on_start()
        self._acted = self._worked = 0.0
        self._pictured, self._pictured_at = 0, 0.0
        self._struck = False
        self._limit = LIMIT + 4.0 * milling_time(incident.door)
        self._asked: float | None = None
        self._begun: float | None = None
        #: What the plant does at which time [s].
        self._plan: list[tuple[float, Callable[[], None]]] = []
        if "named" in incident.kind:
            self.robot.name_door("")
            self.robot.cell.set_input(DOOR_CLAMPED, 0.0)
            self._plan = [(LOADED, self._clamp), (NAMED, self._name_door)]
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
        self._follow_the_plan(now)
        self._judge.watch()
        if now > self._limit:
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
        """The PC: takes a picture at each request, and has a file some time later."""
        if not self.robot.panel.state.powered:
            return
        self._handshake.step()
        now = self._handshake.snapshot
        if not now.accepts_submission or now.state is not State.REQUESTED:
            return
        if now.request_number != self._pictured:
            self._pictured, self._pictured_at = now.request_number, self.robot.now()
            self._runs += 1
        if self.robot.now() - self._pictured_at >= THINKING:
            run_id = f"run-{self._runs}"
            data = render_target_file(door_program(self._incident.door), run_id)
            self._handshake.submit(run_id, self._incident.door, data, self._pictured)
            self._handshake.step()

    def _strike(self, now: float) -> None:
        """Let the incident happen."""
        if self._begun is None and self.robot.context.index >= 0:
            self._begun = now
        if self._asked is None and self.robot.io.read(signals.REQUEST):
            self._asked = now
        exchange, named = "exchange" in self._incident.kind, "named" in self._incident.kind
        begin = 0.0 if named else self._asked if exchange else self._begun
        if begin is None or self._struck or self._incident.kind == "nothing":
            return
        if now >= begin + self._incident.delay and self.robot.panel.running:
            self._struck = self.verdict.struck = True
            ACTIONS[self._incident.kind](self.robot.panel, self.robot)
            # Behind the back of a program that stands: another door of the same kind.
            if exchange:
                acts, delays = (self._release, self._clamp), EXCHANGE
            elif named:
                acts, delays = (
                    (self._clamp, self._name_door, self._release_named, self._clamp),
                    NAMED_EXCHANGE,
                )
            if exchange or named:
                self._plan = [(now + delay, act) for delay, act in zip(delays, acts, strict=True)]

    def _follow_the_plan(self, now: float) -> None:
        if self._plan and now >= self._plan[0][0]:
            self._plan.pop(0)[1]()

    def _clamp(self) -> None:
        self.robot.cell.set_input(DOOR_CLAMPED, 1.0)

    def _release(self) -> None:
        """The next door is named while it is being loaded."""
        self._release_named()
        self._name_door()

    def _release_named(self) -> None:
        """Nobody names the next door before the pendant asks for it."""
        self.robot.cell.set_input(DOOR_CLAMPED, 0.0)
        self._judge.new_door(self._runs, named=False)

    def _name_door(self) -> None:
        """The bar code reader, at the door that is there or is being loaded."""
        (self._home / signals.EXPECTED_FILE).write_text(f"{self._incident.door}\n{signals.EXPECTED_END}\n")
        self._judge.named = True

    def _accepted(self) -> int:
        """Number of the file that the robot said last that it accepted."""
        try:
            text = (self._home / signals.ACCEPTED_FILE).read_text()
        except OSError:
            return 0
        return int(text.splitlines()[0].removeprefix("run-"))

    def _serve_doors(self, now: float) -> None:
        """The plant: takes a door out that is done or failed, and clamps the next one."""
        cell, io = self.robot.cell, self.robot.io
        if not cell.spindle_works and not self.robot.panel.running:
            cell.spindle_works = True
        if self._swap is not None:
            if now >= self._swap:
                self._swap = None
                self._placed += 1
                self._judge.new_door(self._runs)
                if self.robot.program.has_data("expectedDoor"):
                    self.robot.program.write("expectedDoor", f'"{self._incident.door}"')
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
    "exchange at a stop": lambda panel, _: panel.stop(),
    "exchange without power": lambda panel, _: panel.fail_power(),
    "named at a stop": lambda panel, _: panel.stop(),
    "named without power": lambda panel, _: panel.fail_power(),
}


def campaign(runs: int, seed: int) -> list[tuple[Incident, Verdict]]:
    """So many runs from a seed on."""
    return [(incident, Run(incident).mill()) for incident in map(draw, range(seed, seed + runs))]
