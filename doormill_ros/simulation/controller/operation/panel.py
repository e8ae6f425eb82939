"""What an operator, a PLC or Robot Web Services order of the controller, and what it refuses.

Rules and their sources:

- Emergency stop: the state ends by releasing the button and then switching the motors on; category 0 is how it is
  delivered (ABB Product manual IRB 2600, 3HAC035504, 1.2.5.1; IRC5 with FlexPendant, 3HAC021313, 1.2.5.2).
- Guard stop (automatic stop): category 1 as delivered, seen in automatic mode alone, ends when the circuit closes;
  the motors have to be switched on again (3HAC021313, 1.2.5.3).
- The program pointer is moved while the program stands [?]; a change of mode stops the program and
  switches the motors off (seen on a GoFa, docs/rapid.md).
- Override is 0 to 100 per cent (Robot Web Services, `/rw/panel/speedratio`).

[?] marks what was seen in no public source; docs/rapid.md names its manual.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from math import inf
from typing import Protocol

from doormill_ros.abb.errors import AbbError
from doormill_ros.simulation.controller.marked import Marked
from doormill_ros.simulation.controller.operation.states import (
    ControllerState,
    ExecutionState,
    OperatingMode,
    OperationState,
    StopCause,
    StopMode,
)
from doormill_ros.simulation.controller.rapid.errors import OrderRefusedError

#: Event numbers as controllers log them (public list of 3 million entries, SDEBEUL/GADATA, ABB.sp_Housekeeping).
PROGRAM_STOPPED, PROGRAM_RESTARTED, MOTORS_OFF, MOTORS_ON, GUARD_STOP = 10005, 10008, 10010, 10011, 10012
REGAIN_START, REGAIN_READY = 10052, 10053
#: [?]: emergency stop, manual, automatic, program pointer reset.
EMERGENCY_STOP, MANUAL, AUTOMATIC, POINTER_RESET = 10013, 10015, 10017, 10002


class Log(Protocol):
    """Writes an event: kind, title, text and number."""

    def __call__(self, kind: str, title: str, text: str, number: int = 0) -> None:
        """Add it to the event log."""
        ...


class ControlPanel(Marked):
    """State of the controller and the orders it takes; safe to use from several threads.

    An order changes drives and safety chain at once. What it means for program and motion is in `stop_wanted`,
    `start_wanted` and their kin, and happens as simulated time passes.
    """

    def __init__(self, log: Log) -> None:
        """Stand in automatic mode with the motors on and no program running."""
        self._lock = threading.RLock()
        self._log = log
        self._mode = OperatingMode.AUTO
        self._controller = ControllerState.MOTORS_ON
        self._execution = ExecutionState.STOPPED
        self._override = 100.0
        self._cause, self._detail = StopCause.NOT_STARTED, "the program was not started yet"
        self._pointer_lost = False
        self._powered, self._guard_closed, self._button_pressed = True, True, False
        self._later: list[tuple[float, Callable[[], None]]] = []
        self._next_order = inf
        #: What the running program has not reacted to yet.
        self.stop_wanted: StopCause | None = None
        self.stop_category = 1
        self.stop_after_instruction = False
        self.stop_after_cycle = False
        self.start_wanted = False
        self.pointer_wanted = False
        self.reload_wanted = False
        self.restart_wanted = False

    # States

    @property
    def state(self) -> OperationState:
        """One look at all of it."""
        with self._lock:
            return OperationState(
                self._mode,
                self._controller,
                self._execution,
                self._override,
                self._cause,
                self._detail,
                self._pointer_lost,
                self._powered,
            )

    @property
    def guard_closed(self) -> bool:
        """Whether the door circuit is closed."""
        return self._guard_closed

    @property
    def running(self) -> bool:
        """Whether the program runs."""
        return self._execution is ExecutionState.RUNNING

    @property
    def motors_on(self) -> bool:
        """Whether the drives have power."""
        return self._controller is ControllerState.MOTORS_ON

    def system_outputs(self) -> dict[str, int]:
        """Values of the system outputs by the words of `-Status` in EIO.cfg."""
        with self._lock:
            return {
                "AutoOn": int(self._mode is OperatingMode.AUTO),
                "CycleOn": int(self.running),
                "EmStop": int(self._controller is ControllerState.EMERGENCY_STOP),
                "MotOnState": int(self.motors_on),
                "MotOffState": int(not self.motors_on),
                "RunchOk": int(self._guard_closed and not self._button_pressed and self._powered),
                "Error": int(self._cause is StopCause.EXECUTION_ERROR and not self.running),
            }

    # Orders

    def start(self) -> None:
        """Start, or go on where the program stands.

        Raises:
            OrderRefusedError: Motors are off, the program runs, or the pointer is lost.
        """
        with self._lock:
            if not self.motors_on:
                raise self._refused("start", f"the controller is in {self._controller}", "motoron")
            if self.running:
                raise self._refused("start", "the program runs", "a stopped program")
            if self._pointer_lost and not self.pointer_wanted:
                raise self._refused("start", f"the program pointer is lost ({self._detail})", "PP to main")
            self.start_wanted = True

    def stop(self, mode: StopMode = StopMode.STOP) -> None:
        """Stop the program; without effect when it stands."""
        with self._lock:
            self.start_wanted = False
            if not self.running:
                return
            if mode is StopMode.CYCLE:
                self.stop_after_cycle = True
            elif mode is StopMode.INSTRUCTION:
                self.stop_after_instruction = True
            else:
                self._want_stop(StopCause.QUICK_STOP if mode is StopMode.QUICK else StopCause.PROGRAM_STOP, 2)

    def pointer_to_main(self) -> None:
        """Move the program pointer to main: VAR get their initial values, motions left are forgotten.

        Raises:
            OrderRefusedError: The program runs.
        """
        with self._lock:
            if self.running:
                raise self._refused("PP to main", "the program runs", "a stopped program")
            self.pointer_wanted = True

    def reload_modules(self) -> None:
        """Load the modules anew: PERS get the values of their files, the pointer goes to main.

        Raises:
            OrderRefusedError: The program runs.
        """
        with self._lock:
            if self.running:
                raise self._refused("loading modules", "the program runs", "a stopped program")
            self.reload_wanted = self.pointer_wanted = True

    def motors(self, on: bool) -> None:
        """Switch the drives; off while moving is a stop of category 1.

        Raises:
            OrderRefusedError: Emergency stop, an open guard in automatic mode, or no power.
        """
        with self._lock:
            if not on:
                if self._controller is ControllerState.MOTORS_ON:
                    self._want_stop(StopCause.MOTORS_OFF, 1)
                    self._controller = ControllerState.MOTORS_OFF
                    self._log("information", "Motors OFF state", "ordered", MOTORS_OFF)
                return
            if self._controller is ControllerState.MOTORS_ON:
                return
            if self._controller not in (ControllerState.MOTORS_OFF, ControllerState.EMERGENCY_STOP_RESET):
                raise self._refused("motors on", f"the controller is in {self._controller}", "motoroff")
            if not self._guard_closed and self._mode is OperatingMode.AUTO:
                raise self._refused("motors on", "the guard is open", "a closed guard")
            self._controller = ControllerState.MOTORS_ON
            self._log("information", "Motors ON state", "ordered", MOTORS_ON)

    def set_mode(self, mode: OperatingMode) -> None:
        """Turn the mode switch; a change stops the program and switches the motors off [?]."""
        with self._lock:
            if mode is self._mode:
                return
            self._want_stop(StopCause.MODE_CHANGE, 1)
            self._mode = mode
            if self._controller in (ControllerState.MOTORS_ON, ControllerState.GUARD_STOP):
                self._controller = ControllerState.MOTORS_OFF
            if mode is OperatingMode.AUTO and not self._guard_closed:
                self._controller = ControllerState.GUARD_STOP
            manual = mode is not OperatingMode.AUTO
            self._log(
                "information",
                "Manual mode selected" if manual else "Automatic mode confirmed",
                mode.value,
                MANUAL if manual else AUTOMATIC,
            )

    def set_speed_override(self, percent: float) -> None:
        """Set the speed in per cent of the programmed one; 0 holds the robot.

        Raises:
            OrderRefusedError: Not 0 to 100.
        """
        if not 0.0 <= percent <= 100.0:
            raise self._refused("speed override", f"{percent:g} per cent", "0 to 100")
        with self._lock:
            self._override = float(percent)

    def emergency_stop(self, category: int = 0) -> None:
        """Press the emergency stop; category 0 takes the power at once, 1 brakes first."""
        with self._lock:
            self._button_pressed = True
            if not self._powered:
                return
            self._want_stop(StopCause.EMERGENCY_STOP, category)
            self._controller = ControllerState.EMERGENCY_STOP
            self._log("error", "Emergency stop state", f"category {category}", EMERGENCY_STOP)

    def release_emergency_stop(self) -> None:
        """Pull the button; the motors have to be switched on again."""
        with self._lock:
            self._button_pressed = False
            if self._controller is ControllerState.EMERGENCY_STOP:
                self._controller = ControllerState.EMERGENCY_STOP_RESET

    def open_guard(self) -> None:
        """Open the door circuit; without effect on the robot in manual mode."""
        with self._lock:
            self._guard_closed = False
            if self._mode is not OperatingMode.AUTO or not self._powered:
                return
            self._want_stop(StopCause.GUARD_STOP, 1)
            if self._controller in (ControllerState.MOTORS_ON, ControllerState.MOTORS_OFF):
                self._controller = ControllerState.GUARD_STOP
            self._log("error", "Safety guard stop state", "the door circuit is open", GUARD_STOP)

    def close_guard(self) -> None:
        """Close the door circuit."""
        with self._lock:
            self._guard_closed = True
            if self._controller is ControllerState.GUARD_STOP:
                self._controller = ControllerState.MOTORS_OFF

    def fail_power(self) -> None:
        """Take the power away from everything."""
        with self._lock:
            if self._powered:
                self._want_stop(StopCause.POWER_FAILURE, 0)
                self._powered = False
                self._controller = ControllerState.INIT

    def restore_power(self) -> None:
        """Give the power back: the controller starts with its program where it was, motors off."""
        with self._lock:
            if not self._powered:
                self._powered = self.restart_wanted = True
                self._after_start()

    def warm_start(self) -> None:
        """Restart the controller, its program and data kept."""
        with self._lock:
            self._want_stop(StopCause.WARM_START, 1)
            self.restart_wanted = True
            self._after_start()

    def at(self, time: float, order: Callable[[], None]) -> None:
        """Give an order when simulated time comes to `time` [s]."""
        with self._lock:
            self._later.append((time, order))
            self._later.sort(key=lambda item: item[0])
            self._next_order = self._later[0][0]

    # What the controller itself uses

    def next_order_time(self) -> float:
        """When the next order of `at` is due [s], infinite without one."""
        return self._next_order

    def give_due_orders(self, now: float) -> None:
        """Give the orders of `at` that are due; one that is refused is logged."""
        while self._next_order <= now + 1e-9:
            with self._lock:
                _, order = self._later.pop(0)
                self._next_order = self._later[0][0] if self._later else inf
            try:
                order()
            except OrderRefusedError as error:
                self._log("warning", "order refused", error.message)

    def started(self) -> None:
        """The program runs from now on."""
        with self._lock:
            self._execution = ExecutionState.RUNNING
            self.start_wanted = self.pointer_wanted = self._pointer_lost = False

    def stopped(self, cause: StopCause, detail: str, pointer_lost: bool = False) -> None:
        """The program stands from now on."""
        with self._lock:
            self._execution = ExecutionState.STOPPED
            self._cause, self._detail, self._pointer_lost = cause, detail, pointer_lost
            self.stop_wanted, self.stop_after_instruction, self.stop_after_cycle = None, False, False

    def pointer_at_main(self) -> None:
        """The pointer has been moved to main."""
        with self._lock:
            self.pointer_wanted = self.reload_wanted = self._pointer_lost = False
            self._log("information", "Program pointer has been reset", "PP to main", POINTER_RESET)

    def _after_start(self) -> None:
        """State that a restarted controller comes up in."""
        if self._button_pressed:
            self._controller = ControllerState.EMERGENCY_STOP
        elif not self._guard_closed and self._mode is OperatingMode.AUTO:
            self._controller = ControllerState.GUARD_STOP
        else:
            self._controller = ControllerState.MOTORS_OFF

    def _want_stop(self, cause: StopCause, category: int) -> None:
        """Ask the running program to stop; the harder of two stops counts."""
        self.start_wanted = False
        if self.running and (self.stop_wanted is None or category < self.stop_category):
            self.stop_wanted, self.stop_category = cause, category

    def _refused(self, order: str, found: str, allowed: str) -> AbbError:
        return OrderRefusedError(f"{order}: {found}, allowed is {allowed}: bring the controller there first")
