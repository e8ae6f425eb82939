"""The simulated milling robot: its controller, its program, and what it is like in truth."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from doormill_ros.abb import signals
from doormill_ros.arrays import BoolArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.config import read
from doormill_ros.frames import quaternion_wxyz
from doormill_ros.simulation.controller.cabinet.cell import DOOR_CLAMPED
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo, IoPort, MemoryIo
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.motions.limits import ControllerLimits, load_limits
from doormill_ros.simulation.controller.rapid.errors import RapidStoppedError
from doormill_ros.simulation.controller.rapid.machine import Move
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.controller.records.process import listed_process, module_process
from doormill_ros.simulation.errors import EffectsFileError
from doormill_ros.simulation.spindle_load import SpindleDrive
from doormill_ros.simulation.truth.robot import TruthRobot
from doormill_ros.toolpath.program import RACK_KINDS, MillingProgram, Motion, MotionKind, Target
from doormill_ros.units import m_to_mm, rad_to_deg
from doormill_ros.values import Name, Section

NOT_CONNECTED = 9e9  #: RAPID's mark of an external axis that is not there
#: PERS that say which tool is in the spindle, and how long it is.
_OF_THE_TOOLS = ("doortool.toolplace", "doortool.toolmeasured", "doortool.atrack", "doorcell.toolmill")
SPEED_OF_OTHERS = (500.0, 5000.0, 1000.0)  #: reorientation and external axes of the predefined speeds


@dataclass(frozen=True)
class _Effect(Section):
    cause: Name
    where: str | int
    parameters: dict[str, Any]


def load_effects(path: Path) -> tuple[Mapping[str, Any], ...]:
    """Effects for `TruthRobot` from a YAML list of {cause, where, parameters}.

    Raises:
        EffectsFileError: No such file, or no such list.
    """
    return tuple(asdict(effect) for effect in read(path, list[_Effect], EffectsFileError))


class RobotCellRun:
    """One start of the controller's program for one door; made by `RobotCell.start`."""

    def __init__(self, controller: VirtualController) -> None:
        self._controller = controller

    def execute(self) -> bool:
        """Run the program to its end; blocks. False when it was stopped from outside.

        Raises:
            AbbError: The program stopped with an error.
        """
        try:
            self._controller.run()
        except RapidStoppedError:
            return False
        return self._controller.motion_count > 0

    def stop(self) -> None:
        """Stop program and robot; from any thread."""
        self._controller.stop()

    def open_clamp(self) -> None:
        """Somebody opens the clamp, whatever the program does; from any thread."""
        self._controller.cell.set_input(DOOR_CLAMPED, 0.0)

    @property
    def pendant_lines(self) -> tuple[str, ...]:
        """What the program showed on the pendant."""
        return tuple(self._controller.pendant_lines)

    def executed_path(self, program: MillingProgram) -> ExecutedPath:
        """What the tool did, given the wrenches under which the motions cut."""
        return self._controller.executed_path(module_process(program).wrench_of)

    def spindle_turned(self, executed: ExecutedPath) -> BoolArray:
        """Whether the spindle turned at each sample, shape (n,)."""
        return self._controller.spindle_turned(executed.time)


class RobotCell:
    """A controller with a HOME folder and a robot that gives way.

    Args:
        home: Folder behind HOME:; made when it is missing.
        arm: The robot as its controller believes it to be.
        effects: What the robot hides, see `TruthRobot`.
        time_scale: Simulated over real seconds of motion; None for as fast as possible.
        spindle_works: False for a spindle that never comes to speed.
        layout: The robot's rack, tool and home; None for those of config/cell.yaml.
    """

    def __init__(
        self,
        home: Path,
        arm: ControllerArm,
        effects: Iterable[Mapping[str, Any]] = (),
        time_scale: float | None = None,
        spindle_works: bool = True,
        layout: CellLayout | None = None,
    ) -> None:
        self._home = home
        self._layout = layout
        self._arm = arm
        self._spindle_works = spindle_works
        self._truth = TruthRobot(self._arm.dh, effects)
        self._time_scale = time_scale
        #: What the controller refuses and how fast it is, from the next start on; None for config/controller.yaml.
        self.limits: ControllerLimits | None = None
        home.mkdir(parents=True, exist_ok=True)
        #: Signals between the program and the PC.
        self.io: IoPort = FolderIo(home)
        #: Tells how much the spindle gives.
        self.spindle = SpindleDrive(home)
        self._controller: VirtualController | None = None

    @property
    def controller(self) -> VirtualController:
        """The controller as it is now; before the first door one that nobody has started."""
        if self._controller is None:
            self._controller = self._new_controller()
        return self._controller

    def _new_controller(self) -> VirtualController:
        return VirtualController(
            self._home,
            self._arm,
            self._truth,
            io=self.io,
            limits=self.limits,
            layout=self._layout,
            time_scale=self._time_scale,
            on_time=self._time_passed,
        )

    def _time_passed(self, controller: VirtualController) -> None:
        _release(controller)
        self.spindle.advance(controller)

    def reset(self) -> None:
        """Lower what the controller signals, as an operator does who takes a door out."""
        for name in signals.CONTROLLER_SIGNALS:
            self.io.write(name, 0)

    def start(self, door_id: str) -> RobotCellRun:
        """Clamp a door and get the program ready; `execute` runs it.

        The robot stands at home again. PERS keep their values from door to door, as in a real controller:
        the runs that were milled and the number of the last request.
        """
        self.reset()
        controller = self._new_controller()
        if self._controller is not None:
            self._hand_over(self._controller, controller)
        # Whatever became of the door before: it was taken out and the robot was led home.
        for name in ("doorInHand", "doorSpent"):
            controller.program.write(name, "FALSE")
        controller.program.write("stopReason", "0")
        self._controller = controller
        controller.name_door(door_id)
        controller.cell.spindle_works = self._spindle_works
        return RobotCellRun(controller)

    def _hand_over(self, old: VirtualController, new: VirtualController) -> None:
        """What stays from door to door: PERS, the event log, and which tool is where.

        After a door that ended in the middle of a tool change people have put the tools back
        and measured the one in the spindle.
        """
        kept = dict(old.program.persistent_data())
        if any(old.program.read(name) != new.program.read(name) for name in ("toolPlace", "toolMeasured")):
            fresh = new.program.persistent_data()
            kept |= {name: fresh[name] for name in _OF_THE_TOOLS if name in fresh}
        else:
            new.cell.rack.carried, new.cell.rack.standing = old.cell.rack.carried, old.cell.rack.standing
        new.cell.rack.faults = old.cell.rack.faults
        new.cell.show_drawbar()
        new.program.restore(kept)
        new.event_log[:0] = old.event_log

    def execute_uncorrected(self, program: MillingProgram) -> ExecutedPath:
        """What the same robot would have done without the correction.

        The motions go straight to the motion engine: file and program were tried by the run itself. What a controller
        refuses of motions that the correction alone makes acceptable is let through; nobody mills them.

        Raises:
            AbbError: A motion that the controller refuses.
        """
        limits = self.limits or load_limits()
        controller = VirtualController(
            self._home,
            self._arm,
            self._truth,
            io=MemoryIo(),
            process=listed_process(program),
            limits=replace(limits, short_in_row=None, zero_length=False),
            layout=self._layout,
        )
        controller.supervise_configuration(linear=True, on=False)  # as rapid/DoorMill.mod does
        data = controller.program.read
        tool, wobj = data("toolMill"), data("wobjDoor")
        nominal = [_robtarget(target) for target in program.targets]
        for number, motion in enumerate(program.motions):
            if motion.kind in RACK_KINDS:
                controller.wait_in_position()
                controller.cell.rack.hold(motion.via if motion.kind is not MotionKind.PUT else None)
                continue
            controller.move(
                Move(
                    kind=motion.kind.value,
                    target=_target_of(motion, program, nominal),
                    via=None if motion.via is None else nominal[motion.via],
                    speed=[m_to_mm(motion.speed), *SPEED_OF_OTHERS],
                    zone=data(motion.zone),
                    tool=tool,
                    wobj=wobj,
                    duration=None,
                    file="uncorrected program",
                    line=number,
                )
            )
        controller.wait_in_position()
        return controller.executed_path()


def _release(controller: VirtualController) -> None:
    """The clamp opens once the door is milled."""
    if controller.moving:
        return  # nobody opens it before the robot stands, and reading signals takes longer than a step of time
    if controller.io.read(signals.DONE) and controller.program.read("doorSpent"):
        controller.cell.set_input(DOOR_CLAMPED, 0.0)


def _target_of(
    motion: Motion, program: MillingProgram, nominal: list[list[list[float]]]
) -> list[list[float]]:
    """Robtarget, or jointtarget of a motion to a point in joint space."""
    if motion.kind is MotionKind.ABSOLUTE:
        return [rad_to_deg(program.points[motion.target]).tolist(), [NOT_CONNECTED] * 6]
    return nominal[motion.target]


def _robtarget(target: Target) -> list[list[float]]:
    """RAPID robtarget at the nominal pose."""
    position = m_to_mm(target.T_base_tool_nominal[:3, 3]).tolist()
    conf = target.conf
    turns = [float(v) for v in (conf.cf1, conf.cf4, conf.cf6, conf.cfx)]
    return [position, quaternion_wxyz(target.T_base_tool_nominal).tolist(), turns, [NOT_CONNECTED] * 6]
