"""Running the program through everything that stops it.

The program pointer stays where the program was stopped, with all VAR and motions; a start goes on from there after
the robot is back on its path. Only "PP to main" gives the pointer up.

Event routines, by the names of the system parameter Event Routine; when each is called is in parts seen, docs/rapid.md:

- START: a start with the pointer at main. RESTART: a start from where the program stood, before the way back to
  the path and before any motion.
- STOP: after a program stop, a change of mode or motors off. QSTOP: after a quick, emergency or guard stop.
  Neither after an execution error, nor after a loss of power.
- POWERON: the controller is up again. RESET: the modules were loaded anew.

None of them may move the robot, and each but START ends after `event_routine_time` at the latest.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Protocol

from doormill_ros.abb.errors import AbbError
from doormill_ros.simulation.controller.clock import ControllerClock
from doormill_ros.simulation.controller.motion import MotionEngine
from doormill_ros.simulation.controller.motions.limits import ControllerLimits
from doormill_ros.simulation.controller.operation.outputs import OutputMemory
from doormill_ros.simulation.controller.operation.panel import (
    PROGRAM_RESTARTED,
    PROGRAM_STOPPED,
    ControlPanel,
    Log,
)
from doormill_ros.simulation.controller.operation.states import StopCause
from doormill_ros.simulation.controller.rapid.errors import RapidMotionError, RapidStoppedError
from doormill_ros.simulation.controller.rapid.faults import RapidStop
from doormill_ros.simulation.controller.rapid.program import RapidProgram
from doormill_ros.units import m_to_mm

EVENTS = ("POWERON", "START", "RESTART", "STOP", "QSTOP", "RESET")
#: Who holds the robot: the operation of the controller, not the program with StopMove.
OPERATION = "operation"
_QUICK = (StopCause.QUICK_STOP, StopCause.EMERGENCY_STOP, StopCause.GUARD_STOP)
_DOWN = (StopCause.POWER_FAILURE, StopCause.WARM_START)


class PointerMoved(Exception):
    """The program pointer was moved to main: what the program was doing is over."""


class _BrokenOff(Exception):
    """An event routine that took too long."""


class Task(Protocol):
    """The controller, as far as running its program goes."""

    program: RapidProgram

    def pointer_to_main(self) -> None:
        """Supervision as after a start of main."""
        ...

    def reload(self) -> None:
        """Load the modules anew."""
        ...


class Execution:
    """Runs a task's program.

    Attributes:
        event_routines: Names of the routines of each event.
        keeps_on: Whether a program that stopped with an error waits for the operator; else the error is raised.
        regains_first: The other order of a start: back to the path, then RESTART.
        on_started: Called when a program starts at main, after its event routines.
    """

    def __init__(
        self,
        task: Task,
        engine: MotionEngine,
        clock: ControllerClock,
        panel: ControlPanel,
        outputs: OutputMemory,
        log: Log,
        limits: ControllerLimits,
        keeps_on: bool = False,
    ) -> None:
        """Run nothing yet."""
        self._task, self._engine, self._clock, self._panel = task, engine, clock, panel
        self._outputs, self._log, self._limits = outputs, log, limits
        self.event_routines: Mapping[str, Sequence[str]] = {}
        self.keeps_on = keeps_on
        self.regains_first = False
        self.on_started: Callable[[], None] = lambda: None
        self._deadline: float | None = None
        self.in_event = False
        clock.react = self.react

    def run(self, routine: str, cycles: float, reset: bool, started: bool) -> None:
        """Run a procedure in cycles, from its beginning.

        Args:
            routine: Procedure without parameters.
            cycles: How often, infinite for ever.
            reset: VAR get their initial values first.
            started: Start at once; else wait for a start first.
        """
        done, at_main = 0, True
        if reset:
            self._engine.clear()
            self._engine.release("program")
        while done < cycles:
            try:
                if not started:
                    self._stand(at_main)
                    started = True
                if at_main:
                    self._panel.started()
                    self._event("START")
                    self.on_started()
                    self._engine.release(OPERATION)
                    self._check()
                program = self._task.program
                program.run(routine, reset=reset and at_main)
                at_main = False
                if program.pointer_lost and self.keeps_on:
                    self._fail("the program ended itself with EXIT")
                    started, at_main, reset = False, True, True
                    continue
                if self._engine.moving:
                    self._clock.go_on_until(lambda: self._engine.idle)
                done += 1
                if self._panel.stop_after_cycle:
                    self._stopped(StopCause.PROGRAM_STOP)
                    self._go_on()
            except PointerMoved:
                self._to_main()
                started, at_main, reset = False, True, True
            except RapidStoppedError:
                self._panel.stopped(StopCause.ENDED, "the simulation was ended")
                raise
            except AbbError as error:
                self._fail(error.message)
                if not self.keeps_on:
                    raise
                started, at_main, reset = False, True, True
        self._panel.stopped(StopCause.ENDED, "the program has ended")
        self._clock.step(0.0)

    # While the program runs

    def react(self) -> None:
        """Stop when that was ordered; returns when the program goes on.

        Raises:
            PointerMoved: It does not go on.
        """
        if self._panel.stop_wanted is not None:
            self._check()

    def statement(self) -> None:
        """Between two instructions: stop after the one before, or end an event routine that takes too long."""
        if self._deadline is not None and self._clock.now() > self._deadline:
            raise _BrokenOff(f"an event routine ran for more than {self._limits.event_routine_time:g} s")
        if self._panel.stop_after_instruction and not self.in_event:
            self._clock.go_on_until(lambda: self._engine.idle or self._engine.stopped)
            self._stopped(StopCause.PROGRAM_STOP)
            self._event("STOP")
            self._go_on()

    def stop_here(self, instruction: str) -> None:
        """Stop and Break: the program stands until it is started, and goes on behind the instruction.

        Raises:
            PointerMoved: It does not go on.
            RapidStop: In an event routine.
        """
        if self.in_event:
            raise RapidStop(
                f"{instruction} in an event routine, allowed is {instruction} in the program alone"
            )
        self._engine.hold(OPERATION)
        self._clock.settle()
        self._stopped(StopCause.PROGRAM_STOP)
        self._event("STOP")
        self._go_on()

    def check_motion(self, place: str, file: str, line: int) -> None:
        """Refuse a motion that may not be.

        Raises:
            RapidMotionError: In an event routine.
        """
        if self.in_event:
            text = f"{place}: a motion in an event routine, allowed are motions in the program alone"
            self._log("error", "motion supervision", text)
            raise RapidMotionError(text, file=file, line=line)

    def _check(self) -> None:
        cause = self._panel.stop_wanted
        if cause is None or self.in_event:
            return
        category = self._panel.stop_category
        if cause is StopCause.POWER_FAILURE:
            self._outputs.drop()
        if category == 0:
            self._engine.cut_power(OPERATION)
        else:
            self._engine.hold(OPERATION, quick=cause in _QUICK)
        self._clock.settle()
        # A harder stop may have come while it braked.
        harder = self._panel.stop_wanted
        if harder is StopCause.POWER_FAILURE:
            self._outputs.drop()
        cause = harder or cause
        self._stopped(cause)
        if cause not in _DOWN:
            self._event("QSTOP" if cause in _QUICK else "STOP")
        self._go_on()

    def _go_on(self) -> None:
        """Wait for a start, bring the robot back to its path and let it go on."""
        self._stand(at_main=False)
        self._panel.started()
        self._task.program.context.interrupts.discard()
        if self.regains_first:
            self._regain()
        self._event("RESTART")
        self._check()
        if not self.regains_first:
            self._regain()
        self._engine.release(OPERATION)
        self._log("information", "Program restarted", "from where it was stopped", PROGRAM_RESTARTED)

    def _regain(self) -> None:
        while self._engine.regain():
            while self._engine.regaining:
                self._clock.step(self._engine.until_next())
                self._check()

    def _stand(self, at_main: bool) -> None:
        """Wait for a start that can be carried out.

        Raises:
            PointerMoved: The pointer goes to main, unless it is there.
        """
        panel, stood = self._panel, 0.0
        while True:
            if not panel.state.powered:
                self._outputs.drop()
            if panel.restart_wanted:
                panel.restart_wanted = False
                self._outputs.come_back()
                self._event("POWERON")
            if panel.pointer_wanted:
                if not at_main:
                    raise PointerMoved
                self._to_main()
            if panel.start_wanted:
                if at_main or self._near_path():
                    return
                panel.start_wanted = False
            stood += self._clock.stand(stood)

    def _near_path(self) -> bool:
        distance, turn = self._engine.off_path()
        if distance <= self._limits.regain_distance and turn <= self._limits.regain_turn:
            return True
        text = (
            f"the robot is {m_to_mm(distance):.0f} mm from its path, allowed are "
            f"{m_to_mm(self._limits.regain_distance):.0f} mm: move it there or move the pointer to main"
        )
        self._log("error", "regain", text)
        return False

    def _to_main(self) -> None:
        reload = self._panel.reload_wanted
        self._engine.clear()
        self._engine.forget_stored()
        self._engine.release("program")
        self._task.pointer_to_main()
        if reload:
            self._task.reload()
        self._panel.pointer_at_main()
        if reload:
            self._event("RESET")

    def _stopped(self, cause: StopCause) -> None:
        context = self._task.program.context
        text = f"{cause.value} in {context.file or 'the program'}, line {context.line}"
        self._panel.stopped(cause, text)
        self._engine.hold(OPERATION)
        self._log("information", "Program stopped", text, PROGRAM_STOPPED)

    def _fail(self, reason: str) -> None:
        """The program stopped with an error, or ended itself: the pointer is lost."""
        self._engine.hold(OPERATION)
        self._clock.settle()
        self._panel.stopped(StopCause.EXECUTION_ERROR, reason, pointer_lost=True)

    def _event(self, name: str) -> None:
        """Run the routines of an event."""
        program = self._task.program
        for routine in self.event_routines.get(name, ()):
            self._in_event(name, partial(program.run, routine, reset=False))

    def _in_event(self, name: str, run: Callable[[], None]) -> None:
        context = self._task.program.context
        saved = context.file, context.line, context.depth, list(context.devices)
        context.devices.clear()
        self.in_event, self._clock.attended = True, False
        # A trap of what this routine does would run here, and its ExitCycle end this routine alone.
        context.interrupts.held_back = True
        self._deadline = None if name == "START" else self._clock.now() + self._limits.event_routine_time
        try:
            run()
        except _BrokenOff as error:
            self._log("error", "event routine", f"{name}: {error}")
        except RapidStoppedError:
            raise
        except AbbError as error:
            self._log("error", "event routine", f"{name}: {error.message}")
        finally:
            context.file, context.line, context.depth = saved[:3]
            context.devices[:] = saved[3]
            context.interrupts.held_back = False
            self.in_event, self._clock.attended, self._deadline = False, True, None
