"""What a RAPID program reaches of the simulated controller: signals, motions, the pendant and the log."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import inverse, quaternion_wxyz
from doormill_ros.simulation.controller.cabinet.cell import SimulatedCell
from doormill_ros.simulation.controller.cabinet.teach_pendant import TeachPendant
from doormill_ros.simulation.controller.clock import ControllerClock
from doormill_ros.simulation.controller.motion import MotionEngine
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.moves import MovePlanner
from doormill_ros.simulation.controller.operation.execution import Execution
from doormill_ros.simulation.controller.operation.panel import ControlPanel
from doormill_ros.simulation.controller.rapid.faults import RapidFault, RapidStop
from doormill_ros.simulation.controller.rapid.machine import Attendant, Dialog, DialogAnswer, Move
from doormill_ros.simulation.controller.rapid.program import RapidProgram
from doormill_ros.simulation.controller.rapid.types import Value
from doormill_ros.simulation.controller.records.process import Process
from doormill_ros.units import deg_to_rad, m_to_mm, mm_to_m, rad_to_deg

#: Time that one RAPID statement takes [s]; the order of magnitude of a present controller.
STATEMENT_TIME = 20e-6
#: Farther from the path than this the robot does not go on with it [m]; the value is an assumption [?].
PATH_DISTANCE = 0.01
#: Time of statements that is gathered before it passes [s].
LARGEST_DEBT = 0.002
#: Who holds the robot after StopMove.
PROGRAM = "program"


@dataclass(frozen=True)
class LogEntry:
    """One entry of the event log; `kind` is "information", "warning" or "error", `number` 0 where it has none."""

    time: float
    kind: str
    title: str
    text: str
    number: int = 0


class TaskMachine:
    """The seam that the interpreter uses (doormill_ros.simulation.controller.rapid.machine.Machine).

    A `VirtualController` sets everything up.
    """

    program: RapidProgram
    panel: ControlPanel
    cell: SimulatedCell
    teach_pendant: TeachPendant
    event_log: list[LogEntry]
    execution: Execution
    _home: Path
    _arm: ControllerArm
    _engine: MotionEngine
    _planner: MovePlanner
    _clock: ControllerClock
    _process: Process
    _debt: float
    _moves: int

    def set_attendant(self, attendant: Attendant) -> None:
        """Have the interrupts of the program looked after as time passes."""
        self._clock.attendant = attendant

    @property
    def home(self) -> Path:
        """Folder behind HOME:."""
        return self._home

    def signal_kinds(self) -> dict[str, str]:
        """Configured signals and their RAPID types."""
        return self.cell.kinds

    def read_signal(self, name: str) -> float:
        """Present value of a signal."""
        self.cell.reach(name)
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
        if self._debt > LARGEST_DEBT:
            debt, self._debt = self._debt, 0.0
            self._clock.pass_time(debt)
        self.execution.statement()

    def stop_program(self, instruction: str) -> None:
        """Stand until the operator starts the program again."""
        self.execution.stop_here(instruction)

    def wait(self, condition: Callable[[], bool] | None, seconds: float | None) -> bool:
        """Let time pass until the condition holds or the seconds are over."""
        return self._clock.wait(condition, seconds)

    def move(self, move: Move) -> None:
        """Plan a motion, queue it, and hold the program pointer at stop points."""
        self.execution.check_motion(move.kind, move.file, move.line)
        # A trap may change the path while there is no room, so it is planned after that.
        context = self._process.context_of(self.program, self._moves)
        self._moves += 1
        self._clock.go_on_until(lambda: self._engine.has_room)
        tool = self._engine.planned_tool
        pose = self._engine.planned_pose
        if (
            pose is not None
            and tool is not None
            and not np.array_equal(tool[:3, 3], mm_to_m(np.array(move.tool[1][0])))
        ):
            pose = None  # another tool: its pose follows from the joints
        planned = self._planner.plan(move, self._engine.planned_q, pose, context)
        self._engine.take(planned)
        if planned.zone == 0.0:
            self.wait_in_position()

    def wait_in_position(self) -> None:
        """Let time pass until the robot stands where it is going; a stopped one does not get there."""
        self._clock.go_on_until(lambda: self._engine.idle)

    def wait_at_rest(self) -> None:
        """Let time pass until the robot stands still, at the end of its path or stopped on it."""
        self._clock.go_on_until(lambda: not self._engine.moving)

    def stop_motion(self, clear: bool) -> None:
        """Stop the robot on its path; `clear` forgets what is left."""
        self._engine.hold(PROGRAM, quick=True)
        self._clock.settle()
        if clear:
            self._engine.clear()

    def restart_motion(self) -> None:
        """Go on with what was stopped."""
        distance, _ = self._engine.off_path()
        if distance > PATH_DISTANCE:
            raise RapidFault(
                "ERR_PATHDIST", f"StartMove: the robot is {m_to_mm(distance):.0f} mm from its path"
            )
        while self._engine.regain():
            self._clock.go_on_until(lambda: not self._engine.regaining)
        self._engine.release(PROGRAM)

    def forget_paths(self) -> None:
        """Forget every motion, on the path and put aside."""
        self.stop_motion(clear=True)
        self._engine.forget_stored()
        self._engine.release(PROGRAM)

    def store_path(self) -> None:
        """Put the path aside, once the robot stands."""
        if self._engine.moving:
            self.wait_in_position()
        if self._engine.has_stored:
            raise RapidStop("StorePath: a path is stored already, allowed is one: call RestoPath first")
        self._engine.store(PROGRAM)

    def restore_path(self) -> None:
        """Take the path up again, once the robot stands."""
        if not self._engine.has_stored:
            raise RapidStop("RestoPath: no path is stored: call StorePath first")
        self.wait_in_position()
        self._engine.restore(PROGRAM)

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
        return self._target(self._engine.q, tool, wobj)

    def _target(self, q: FloatArray, tool: Value, wobj: Value) -> Value:
        """Robtarget of joint angles, shape (6,) [rad]."""
        frame = self._planner.frame
        T_wobj_base = inverse(frame(wobj[3]) @ frame(wobj[4]))
        pose = T_wobj_base @ self._arm.forward(q)[0] @ frame(tool[1])
        numbers = [float(np.float32(v)) for v in (*m_to_mm(pose[:3, 3]), *quaternion_wxyz(pose))]
        conf = [float(c) for c in self._arm.conf_of(q)]
        return [numbers[:3], numbers[3:], conf, [float(np.float32(9e9))] * 6]

    def joints_of(self, target: Value, tool: Value, wobj: Value) -> list[float] | None:
        """Joint angles of a target in its configuration [deg]."""
        frame = self._planner.frame
        T_base_flange = frame(wobj[3]) @ frame(wobj[4]) @ frame(target) @ inverse(frame(tool[1]))
        cf1, cf4, cf6, cfx = (int(value) for value in target[2])
        q = self._arm.in_configuration(T_base_flange, (cf1, cf4, cf6), cfx)
        return None if q is None else [float(np.float32(angle)) for angle in rad_to_deg(q)]

    def target_of(self, joints: Value, tool: Value, wobj: Value) -> Value:
        """Target of joint angles [deg]."""
        return self._target(deg_to_rad(np.array(joints)), tool, wobj)

    def pendant(self, text: str) -> None:
        """Show a line on the pendant."""
        self.teach_pendant.lines.append(text)

    def show_dialog(self, dialog: Dialog | None) -> None:
        """Show a question on the pendant."""
        self.teach_pendant.show(dialog)

    def dialog_answer(self) -> DialogAnswer | None:
        """What the operator chose."""
        return self.teach_pendant.answer

    def operating_mode(self) -> str:
        """AUTO, MANR or MANF."""
        return self.panel.state.mode.value

    def log(self, kind: str, title: str, text: str, number: int = 0) -> None:
        """Add to the event log, a repeated entry once."""
        if not self.event_log or (self.event_log[-1].title, self.event_log[-1].text) != (title, text):
            self.event_log.append(LogEntry(float(self.now()), kind, title, text, number))
