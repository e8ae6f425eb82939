"""A robot controller in software: runs RAPID modules and moves a simulated, compliant robot."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.layout import load_layout
from doormill_ros.frames import inverse, quaternion_wxyz
from doormill_ros.resources import resource
from doormill_ros.simulation.controller.arm import ControllerArm
from doormill_ros.simulation.controller.cell import SimulatedCell, read_io_configuration
from doormill_ros.simulation.controller.executed_path import ExecutedPath
from doormill_ros.simulation.controller.io_port import IoPort, MemoryIo
from doormill_ros.simulation.controller.motion import MotionEngine, Sampling
from doormill_ros.simulation.controller.moves import MovePlanner
from doormill_ros.simulation.controller.process import Process, WrenchOf, module_process
from doormill_ros.simulation.controller.rapid.errors import RapidStoppedError
from doormill_ros.simulation.controller.rapid.machine import Move
from doormill_ros.simulation.controller.rapid.parser import parse_module
from doormill_ros.simulation.controller.rapid.program import RapidProgram
from doormill_ros.simulation.controller.rapid.types import Value
from doormill_ros.simulation.controller.recorded_path import build_executed_path
from doormill_ros.simulation.truth.robot import TruthRobot
from doormill_ros.units import deg_to_rad, m_to_mm, mm_to_m, rad_to_deg

#: What the project ships for the controller.
OWN_MODULES = ("rapid/DoorMill.mod", "rapid/DoorFile.mod", "rapid/DoorCell.mod")
IO_CONFIGURATION = "rapid/EIO.cfg"
#: PERS of DoorFile.mod that names the door in the cell.
EXPECTED_DOOR = "expectedDoor"
#: Time that one RAPID statement takes [s]; the order of magnitude of a present controller.
STATEMENT_TIME = 20e-6
#: So much time passes at least, lest a motion without length keeps everything waiting [s].
SHORTEST_STEP = 1e-6
#: Where the robot stands when the controller is switched on: the home position of DoorCell.mod.
HOME_POSITION = deg_to_rad(np.array([0.0, -40.0, 30.0, 0.0, 10.0, 0.0]))


@dataclass(frozen=True)
class LogEntry:
    """One entry of the event log; `kind` is "information", "warning" or "error"."""

    time: float
    kind: str
    title: str
    text: str


class VirtualController:
    """Runs one RAPID task on simulated time.

    Motion takes simulated time only, unless `time_scale` is given. While the program waits for a
    signal that somebody outside may set, simulated time follows the wall clock, so that time
    limits mean what they say.

    Attributes:
        program: The loaded modules; `program.write("expectedDoor", '"door"')` sets data.
        cell: The signals; `cell.set_input` plays the plant.
        pendant_lines: What the program showed on the pendant.
        event_log: Entries in the order of time.
    """

    def __init__(
        self,
        home: str | Path,
        arm: ControllerArm,
        truth: TruthRobot | None = None,
        *,
        modules: Sequence[str | Path] | None = None,
        io: IoPort | None = None,
        process: Process | None = None,
        io_configuration: Path | None = None,
        sampling: Sampling | None = None,
        start: FloatArray = HOME_POSITION,
        T_flange_tool: FloatArray | None = None,
        expected_door: str | None = None,
        time_scale: float | None = None,
        patience: float | None = None,
        on_wait: Callable[[VirtualController], None] | None = None,
        on_time: Callable[[VirtualController], None] | None = None,
    ) -> None:
        """Load modules and stand at the start position.

        Args:
            home: Folder behind HOME:.
            arm: The robot as the controller believes it to be.
            truth: The robot as it is; None for one exactly as the controller believes.
            modules: Module files; None for the project's own.
            io: Signals of the handshake; None keeps them in memory.
            process: Which motions cut and how hard; None cuts air with the project's own module.
            io_configuration: EIO.cfg; None for the project's own.
            sampling: How finely the executed path is recorded.
            start: Joint angles at the start, shape (6,) [rad].
            T_flange_tool: The tool that is really mounted, shape (4, 4); None for the cell's.
            expected_door: Door that stands in the cell, "*" for any; None leaves the module's value.
            time_scale: Simulated over real seconds for motions; None for as fast as possible.
            patience: Longest wait for a signal [s] before the program is stopped; None for ever.
            on_wait: Called again and again while the program waits for a signal; then simulated time
                no longer follows the wall clock.
            on_time: Called whenever time has passed, for displays.

        Raises:
            AbbError: What the modules or the I/O configuration do wrong, with file and line.
        """
        self._home = Path(home)
        self._arm = arm
        self._truth = truth or TruthRobot(arm.dh)
        self._rigid = truth is None
        kinds, limits = read_io_configuration(io_configuration or resource(IO_CONFIGURATION))
        self.io: IoPort = io or MemoryIo()
        self.cell = SimulatedCell(kinds, limits, self.io)
        self._process = process or module_process()
        self.pendant_lines: list[str] = []
        self.event_log: list[LogEntry] = []
        self._T_flange_tool = load_layout().T_flange_tool if T_flange_tool is None else T_flange_tool
        self._engine = MotionEngine(arm, start, self._T_flange_tool, sampling or Sampling(), self.log)
        self._planner = MovePlanner(arm, self.log)
        self._time_scale, self._patience = time_scale, patience
        self._on_wait, self._on_time = on_wait, on_time
        self._stop = threading.Event()
        self._debt = 0.0
        self._moves = 0
        paths = [resource(name) for name in OWN_MODULES] if modules is None else [Path(m) for m in modules]
        parsed = [parse_module(_module_text(path), path.name) for path in paths]
        self.program = RapidProgram(parsed, self)
        if expected_door is not None:
            self.program.write(EXPECTED_DOOR, f'"{expected_door}"')

    # What the surroundings use

    def run(self, routine: str = "main", cycles: int = 1, reset: bool = True) -> None:
        """Run a procedure; blocks until it ends.

        Args:
            routine: Procedure without parameters.
            cycles: How often, as in continuous operation.
            reset: Set VAR to their initial values before the first cycle.

        Raises:
            RapidRuntimeError: The program stopped with an error.
            RapidMotionError: The motion supervision stopped the robot.
            RapidStoppedError: `stop` was called, or a signal kept the program waiting too long.
        """
        self._engine.restart()
        for cycle in range(cycles):
            self.program.run(routine, reset=reset and cycle == 0)
            self.wait_in_position()

    def stop(self) -> None:
        """End the program from another thread."""
        self._stop.set()

    def executed_path(self, wrench_of: WrenchOf | None = None) -> ExecutedPath:
        """What the robot has done so far.

        Args:
            wrench_of: Wrenches that acted, where they were not known before; None for the process' own.

        Raises:
            ValueError: It has not moved.
        """
        truth = None if self._rigid else self._truth
        return build_executed_path(
            self._engine.recording, truth, self._T_flange_tool, wrench_of or self._process.wrench_of
        )

    @property
    def q(self) -> FloatArray:
        """Joint angles where the robot stands, shape (6,) [rad]."""
        return self._engine.q.copy()

    @property
    def motion_count(self) -> int:
        """Motion instructions executed so far."""
        return self._moves

    # What the RAPID program uses (doormill_ros.simulation.controller.rapid.machine.Machine)

    @property
    def home(self) -> Path:
        """Folder behind HOME:."""
        return self._home

    def signal_kinds(self) -> dict[str, str]:
        """Configured signals and their RAPID types."""
        return self.cell.kinds

    def read_signal(self, name: str) -> float:
        """Present value of a signal."""
        return self.cell.read(name)

    def write_signal(self, name: str, value: float) -> None:
        """Set an output."""
        self.cell.write(name, value, self.now())

    def now(self) -> float:
        """Simulated time [s]."""
        return self._engine.time

    def statement(self, _file: str, _line: int) -> None:
        """Count a statement's time, and stop when told to."""
        self._debt += STATEMENT_TIME
        if self._debt > 0.002:
            self._pass(self._debt)
            self._debt = 0.0

    def wait(self, condition: Callable[[], bool] | None, seconds: float | None) -> bool:
        """Let time pass until the condition holds or the seconds are over."""
        end = np.inf if seconds is None else self.now() + seconds
        waited = 0.0
        while condition is None or not condition():
            left = end - self.now()
            if left <= 0.0:
                return False
            if condition is None:
                self._pass(min(left, self._engine.until_next() or left))
                continue
            before = self.now()
            self._wait_a_little(left)
            waited += self.now() - before
            if self._patience is not None and waited > self._patience:
                raise RapidStoppedError(
                    f"the program waited {waited:.1f} s for a signal, allowed are {self._patience:g} s: "
                    "check the other side of the handshake"
                )
        return True

    def move(self, move: Move) -> None:
        """Plan a motion, queue it, and hold the program pointer at stop points."""
        context = self._process.context_of(self.program, self._moves)
        tool = self._engine.planned_tool
        pose = self._engine.planned_pose
        if (
            pose is not None
            and tool is not None
            and not np.array_equal(tool[:3, 3], mm_to_m(np.array(move.tool[1][0])))
        ):
            pose = None  # another tool: its pose follows from the joints
        planned = self._planner.plan(move, self._engine.planned_q, pose, context)
        self._moves += 1
        while not self._engine.has_room and not self._engine.paused:
            self._pass(max(self._engine.until_next(), SHORTEST_STEP))
        self._engine.take(planned)
        if planned.zone == 0.0:
            self.wait_in_position()

    def wait_in_position(self) -> None:
        """Let time pass until the robot stands."""
        while self._engine.moving:
            self._pass(max(self._engine.until_next(), SHORTEST_STEP))

    def stop_motion(self, clear: bool) -> None:
        """Stop the robot where it is."""
        self._engine.stop(clear)

    def restart_motion(self) -> None:
        """Go on with what was stopped."""
        self._engine.restart()

    def supervise_configuration(self, linear: bool, on: bool) -> None:
        """ConfL and ConfJ."""
        if linear:
            self._planner.linear_supervision = on
        else:
            self._planner.joint_configuration = on

    def current_joints(self) -> list[float]:
        """Joint angles [deg]."""
        return [float(np.float32(angle)) for angle in rad_to_deg(self._engine.q)]

    def current_target(self, tool: Value, wobj: Value) -> Value:
        """Where the robot stands as a robtarget."""
        frame = self._planner.frame
        T_wobj_base = inverse(frame(wobj[3]) @ frame(wobj[4]))
        pose = T_wobj_base @ self._arm.forward(self._engine.q)[0] @ frame(tool[1])
        numbers = [float(np.float32(v)) for v in (*m_to_mm(pose[:3, 3]), *quaternion_wxyz(pose))]
        conf = [float(c) for c in self._arm.conf_of(self._engine.q)]
        return [numbers[:3], numbers[3:], conf, [float(np.float32(9e9))] * 6]

    def pendant(self, text: str) -> None:
        """Show a line on the pendant."""
        self.pendant_lines.append(text)

    def log(self, kind: str, title: str, text: str) -> None:
        """Add to the event log, a repeated entry once."""
        if not self.event_log or (self.event_log[-1].title, self.event_log[-1].text) != (title, text):
            self.event_log.append(LogEntry(float(self.now()), kind, title, text))

    # Time

    def _pass(self, seconds: float) -> None:
        """Let simulated time pass, and real time with it when a scale is set."""
        if self._stop.is_set():
            raise RapidStoppedError("the program was stopped from outside")
        self._engine.advance(seconds)
        self.cell.advance(self.now())
        if self._time_scale:
            time.sleep(seconds / self._time_scale)
        if self._on_time is not None:
            self._on_time(self)

    def _wait_a_little(self, left: float) -> None:
        """One step of waiting for a condition."""
        if self._engine.moving:
            self._pass(min(left, self._engine.until_next(), 0.01) or SHORTEST_STEP)
            return
        event = self.cell.next_event()
        if event is not None:
            self._pass(min(left, max(event - self.now(), 0.0)))
        elif self._on_wait is not None:
            self._pass(min(left, 0.01))
            self._on_wait(self)
        else:
            start = time.perf_counter()
            time.sleep(0.001)
            elapsed = (time.perf_counter() - start) * (self._time_scale or 1.0)
            self._engine.advance(min(left, elapsed))
            if self._stop.is_set():
                raise RapidStoppedError("the program was stopped from outside")


def _module_text(path: Path) -> str:
    """A module as text; controllers write ISO 8859-1."""
    return path.read_bytes().decode("latin-1")
