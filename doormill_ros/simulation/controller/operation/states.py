"""States of the controller by the names that Robot Web Services give them.

Names of modes, controller and execution states: Robot Web Services 1.0, `/rw/panel/opmode`, `/rw/panel/ctrlstate`
and `/rw/rapid/execution` (developercenter.robotstudio.com, 3HAC050973-001).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class OperatingMode(StrEnum):
    """Position of the mode switch."""

    AUTO = "AUTO"
    MANUAL_REDUCED = "MANR"
    MANUAL_FULL = "MANF"


class ControllerState(StrEnum):
    """State of drives and safety chain."""

    INIT = "init"
    MOTORS_ON = "motoron"
    MOTORS_OFF = "motoroff"
    GUARD_STOP = "guardstop"
    EMERGENCY_STOP = "emergencystop"
    EMERGENCY_STOP_RESET = "emergencystopreset"
    SYSTEM_FAILURE = "sysfail"


class ExecutionState(StrEnum):
    """Whether the program runs."""

    RUNNING = "running"
    STOPPED = "stopped"


class StopMode(StrEnum):
    """How an ordered program stop ends the motion; the values are those of `stopmode`."""

    STOP = "stop"  #: at once, braking on the path
    QUICK = "qstop"  #: at once, braking as hard as the drives can
    INSTRUCTION = "instr"  #: after the instruction, in its position
    CYCLE = "cycle"  #: after main


class StopCause(StrEnum):
    """Why the program does not run."""

    NOT_STARTED = "not started"
    ENDED = "program ended"
    PROGRAM_STOP = "program stop"
    QUICK_STOP = "quick stop"
    EMERGENCY_STOP = "emergency stop"
    GUARD_STOP = "guard stop"
    MOTORS_OFF = "motors off"
    MODE_CHANGE = "mode changed"
    POWER_FAILURE = "power failure"
    WARM_START = "restart of the controller"
    EXECUTION_ERROR = "execution error"


@dataclass(frozen=True)
class OperationState:
    """One look at the controller.

    Attributes:
        mode: Operating mode.
        controller: State of drives and safety chain.
        execution: Whether the program runs.
        speed_override: Per cent of the programmed speed, 0 to 100.
        cause: Why the program stands; of the last stop while it runs.
        detail: One sentence about it.
        pointer_lost: The program pointer has to be moved to main before a start.
        powered: False from a power failure until power is back.
    """

    mode: OperatingMode
    controller: ControllerState
    execution: ExecutionState
    speed_override: float
    cause: StopCause
    detail: str
    pointer_lost: bool
    powered: bool
