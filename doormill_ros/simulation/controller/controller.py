"""A robot controller in software: runs RAPID modules and moves a simulated, compliant robot."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.cell.places.layout import CellLayout, load_layout
from doormill_ros.simulation.controller.cabinet.cell import SimulatedCell
from doormill_ros.simulation.controller.cabinet.io_port import IoPort, MemoryIo
from doormill_ros.simulation.controller.cabinet.teach_pendant import TeachPendant
from doormill_ros.simulation.controller.cabinet.tool_rack import ToolRack
from doormill_ros.simulation.controller.clock import ControllerClock, Pace
from doormill_ros.simulation.controller.commissioned import restore, saved_data
from doormill_ros.simulation.controller.configuration.event_routines import check_event_routines
from doormill_ros.simulation.controller.configuration.installed import Installed, read_installed
from doormill_ros.simulation.controller.motion import MotionEngine
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.motions.limits import ControllerLimits, load_limits
from doormill_ros.simulation.controller.moves import MotionContext, MovePlanner
from doormill_ros.simulation.controller.operation.execution import Execution
from doormill_ros.simulation.controller.operation.outputs import OutputMemory
from doormill_ros.simulation.controller.operation.panel import ControlPanel
from doormill_ros.simulation.controller.rapid.errors import RapidStoppedError
from doormill_ros.simulation.controller.rapid.program import RapidProgram
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.controller.records.process import Process, WrenchOf, module_process
from doormill_ros.simulation.controller.records.recorded_path import build_executed_path
from doormill_ros.simulation.controller.records.recording import MotionRecording, Sampling
from doormill_ros.simulation.controller.task_machine import LogEntry, TaskMachine
from doormill_ros.simulation.truth.robot import TruthRobot

#: PERS of DoorLink.mod that names the door in the cell.
EXPECTED_DOOR = "expectedDoor"


class VirtualController(TaskMachine):
    """Runs one RAPID task on simulated time.

    Motion takes simulated time only, unless `time_scale` is given. While the program waits for a
    signal that somebody outside may set, simulated time follows the wall clock, so that time
    limits mean what they say.

    Attributes:
        program: The loaded modules; `program.write("expectedDoor", '"door"')` sets data.
        cell: The signals; `cell.set_input` plays the plant.
        event_log: Entries in the order of time.
    """

    def __init__(
        self,
        home: str | Path,
        arm: ControllerArm,
        truth: TruthRobot | None = None,
        *,
        installed: Installed | None = None,
        io: IoPort | None = None,
        process: Process | None = None,
        sampling: Sampling | None = None,
        limits: ControllerLimits | None = None,
        start: FloatArray | None = None,
        T_flange_tool: FloatArray | None = None,
        layout: CellLayout | None = None,
        expected_door: str | None = None,
        commissioned: bool = True,
        time_scale: float | None = None,
        patience: float | None = None,
        on_wait: Callable[[VirtualController], None] | None = None,
        on_time: Callable[[VirtualController], None] | None = None,
        on_stopped: Callable[[VirtualController], None] | None = None,
    ) -> None:
        """Load the modules and stand at the start position, motors on, in automatic mode.

        Args:
            home: Folder behind HOME:.
            arm: The robot as the controller believes it to be.
            truth: The robot as it is; None for one exactly as the controller believes.
            installed: Modules and system parameters; None for the project's own.
            io: Signals of the handshake; None keeps them in memory.
            process: Which motions cut and how hard; None cuts air with the project's own module.
            sampling: How finely the executed path is recorded.
            limits: What is refused of motions; None for config/controller.yaml.
            start: Joint angles at the start, shape (6,) [rad]; None for the layout's home.
            T_flange_tool: The tool that is really mounted, shape (4, 4); None for the cell's.
            layout: The robot's rack, tool and home; None for those of config/cell.yaml.
            expected_door: Door that stands in the cell, "*" for any, see `name_door`; None for one that nobody names.
            commissioned: The tool was measured and the modules saved with it; False for them as they are shipped.
            time_scale: Simulated over real seconds for motions; None for as fast as possible.
            patience: Longest wait for a signal or a start [s] before the program is ended; None for ever.
            on_wait: Called again and again while the program waits for a signal; then simulated time
                no longer follows the wall clock.
            on_time: Called whenever time has passed, for displays.
            on_stopped: Called again and again while the program stands: the operator. With one, a program
                that stopped with an error waits for "PP to main" instead of raising it.

        Raises:
            AbbError: What the modules do wrong, with file and line.
            ControllerLimitsError: The limits cannot be read.
        """
        self._home = Path(home)
        self._arm = arm
        self._truth = truth or TruthRobot(arm.dh)
        self._rigid = truth is None
        installed = installed or read_installed()
        self.io: IoPort = io or MemoryIo()
        layout = layout or load_layout()
        rack = ToolRack(layout.rack, lambda q: arm.forward(q)[0])
        self.cell = SimulatedCell(installed.signals, self.io, rack, lambda: arm.forward(self._engine.q)[0])
        self._process = process or module_process()
        #: Lines, dialogs and who answers them.
        self.teach_pendant = TeachPendant()
        self.event_log: list[LogEntry] = []
        #: States of the controller and the orders it takes.
        self.panel = ControlPanel(self.log)
        self._T_flange_tool = layout.T_flange_tool if T_flange_tool is None else T_flange_tool
        limits = limits or load_limits()
        start = layout.home if start is None else start
        self._engine = MotionEngine(arm, start, self._T_flange_tool, sampling or Sampling(), self.log, limits)
        self._planner = MovePlanner(arm, self.log, limits)
        self._on_time = on_time
        pace = Pace(
            time_scale,
            patience,
            None if on_wait is None else lambda: on_wait(self),
            None if on_stopped is None else lambda: on_stopped(self),
            self._time_passed,
        )
        self._clock = ControllerClock(self._engine, self.cell, self.panel, pace)
        self._debt = 0.0
        self._moves = 0
        outputs = OutputMemory(
            [name for name, signal in installed.signals.signals.items() if signal.output],
            installed.signals.safe_outputs,
            self.cell.read,
            self.cell.force,
        )
        #: Runs the program through stops; its `event_routines` are the system parameter's.
        self.execution = Execution(
            self, self._engine, self._clock, self.panel, outputs, self.log, limits, on_stopped is not None
        )
        self._clock.system = installed.outputs
        self._modules = installed.modules
        self.program = RapidProgram(self._modules, self)
        self._saved = saved_data(self.program, self._home) if commissioned else {}
        restore(self.program, self._saved)
        check_event_routines(installed.event_routines, self.program)
        self.execution.event_routines = installed.event_routines
        self._named: str | None = None
        self.execution.on_started = self._tell_name
        if expected_door is not None:
            self.name_door(expected_door)

    # What the surroundings use

    def name_door(self, door_id: str) -> None:
        """Have the panel name the door in the clamp with the next start: the program forgets names from before it."""
        self._named = door_id

    def _tell_name(self) -> None:
        if self._named is not None:
            self.program.write(EXPECTED_DOOR, f'"{self._named}"')
        self._named = None

    def run(self, routine: str = "main", cycles: int = 1, reset: bool = True) -> None:
        """Start a procedure; blocks until it ends, through everything that stops it.

        Args:
            routine: Procedure without parameters.
            cycles: How often, as in continuous operation.
            reset: Set VAR to their initial values before the first cycle.

        Raises:
            OrderRefusedError: The motors are off.
            RapidRuntimeError: The program stopped with an error.
            RapidMotionError: The motion supervision stopped the robot.
            RapidStoppedError: `stop` was called, or a signal kept the program waiting too long.
        """
        self.panel.start()
        self.execution.run(routine, cycles, reset, started=True)

    def serve(self) -> None:
        """Wait for a start and run main in cycles, through everything that stops it, until `stop`."""
        self.execution.keeps_on = True
        with suppress(RapidStoppedError):
            self.execution.run("main", np.inf, True, started=False)

    def stop(self) -> None:
        """End the simulation from another thread; an operator's stop is `panel.stop`."""
        self._clock.end()

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

    def spindle_turned(self, time: FloatArray) -> BoolArray:
        """Whether the spindle was up to speed, or changed to another one, at simulated times (n,) [s]; shape (n,)."""
        began = [moment for moment, _ in self.cell.spindle_turned]
        turned = np.array([False, *(on for _, on in self.cell.spindle_turned)])
        then: BoolArray = turned[np.searchsorted(began, time, side="right")]
        return then

    @property
    def q(self) -> FloatArray:
        """Joint angles where the robot stands, shape (6,) [rad]."""
        return self._engine.q.copy()

    @property
    def motion_count(self) -> int:
        """Motion instructions executed so far."""
        return self._moves

    @property
    def recording(self) -> MotionRecording:
        """Samples of the commanded motion so far."""
        return self._engine.recording

    @property
    def pendant_lines(self) -> list[str]:
        """What the program showed on the pendant."""
        return self.teach_pendant.lines

    @property
    def context(self) -> MotionContext:
        """What the motion is for in which the robot is, or was last."""
        return self._engine.context

    @property
    def moving(self) -> bool:
        """Whether the robot moves."""
        return self._engine.moving

    # What running the program uses (doormill_ros.simulation.controller.operation.execution.Task)

    def pointer_to_main(self) -> None:
        """Supervision as after a start of main: ConfL and ConfJ are on (industrialmonitordirect.com, ConfL)."""
        self._planner.linear_supervision = self._planner.joint_configuration = True

    def reload(self) -> None:
        """Load the modules anew, as Reset RAPID does: all data get the values of the files."""
        self.program = RapidProgram(self._modules, self)
        restore(self.program, self._saved)

    def _time_passed(self) -> None:
        if self._on_time is not None:
            self._on_time(self)
