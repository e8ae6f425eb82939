"""What the controller says of itself, and whether the robot could take a file now."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from doormill_ros.abb.link_errors import ControllerStateError

AUTOMATIC = "AUTO"
MOTORS_ON = "motoron"
EMERGENCY_STOP = "emergencystop"
GUARD_STOP = "guardstop"
RUNNING = "running"

_DRIVES = {
    "init": "the controller is starting: wait until it is up",
    "motoroff": "the motors are off: switch them on and start the program",
    GUARD_STOP: "the guard is open: close it, acknowledge it, switch the motors on and start the program",
    EMERGENCY_STOP: "the emergency stop is pressed: find out why, release it, switch the motors on and start the "
    "program",
    "emergencystopreset": "the emergency stop was released: switch the motors on and start the program",
    "sysfail": "the controller has a system failure: read its event log and restart it",
}


@dataclass(frozen=True)
class ControllerReading:
    """One look at the controller.

    Attributes:
        operating_mode: "AUTO", "MANR" (manual, reduced speed), "MANF" (manual, full speed), or on its way there.
        controller_state: "motoron", "motoroff", "guardstop", "emergencystop", "emergencystopreset", "init", "sysfail".
        execution_state: "running" or "stopped".
        speed_override: Share of the programmed speed, 0 to 1.
        privilege: In manual mode: the operator lets this PC write.
    """

    operating_mode: str
    controller_state: str
    execution_state: str
    speed_override: float
    privilege: bool = False

    @property
    def hindrance(self) -> str:
        """Why the robot cannot take a file and what to do, "" when it can."""
        if self.controller_state != MOTORS_ON:
            unknown = f"the controller is in state {self.controller_state!r}: see its pendant"
            return _DRIVES.get(self.controller_state, unknown)
        if self.operating_mode != AUTOMATIC and not self.privilege:
            return (
                f"the controller is in mode {self.operating_mode}: turn it to automatic, or for a dry run in manual "
                "mode set the bridge's parameter manual_mode and confirm the remote privilege on the pendant"
            )
        if self.execution_state != RUNNING:
            return "the robot program is stopped: start it on the pendant"
        if self.speed_override <= 0.0:
            return "the speed override is 0 %: raise it on the pendant"
        return ""

    @property
    def caution(self) -> str:
        """What spoils doors of a robot that takes files, and what to do; "" for nothing."""
        if self.hindrance or self.operating_mode != AUTOMATIC or self.speed_override >= 1.0:
            return ""
        return (
            f"the speed override is {100.0 * self.speed_override:.0f} %: feeds and chips are as much smaller than "
            "the recipes', and wood burns at small ones: raise it to 100 %"
        )

    def require_fit(self) -> None:
        """Refuse to announce a file to a robot that cannot take it.

        Raises:
            ControllerStateError: Says what hinders and what to do.
        """
        if self.hindrance:
            raise ControllerStateError(
                f"no file is announced, because {self.hindrance}",
                operating_mode=self.operating_mode,
                controller_state=self.controller_state,
                execution_state=self.execution_state,
            )


@dataclass(frozen=True)
class ControllerEvent:
    """An entry of the controller's event log.

    Attributes:
        number: Its number in the log.
        severity: 1 information, 2 warning, 3 error.
        code: Number of the kind of event.
        title: Its title.
        text: Its description.
    """

    number: int
    severity: int
    code: int
    title: str
    text: str


@runtime_checkable
class ControllerWatch(Protocol):
    """A transport that can also tell how the controller is; one that only moves files and signals cannot."""

    def read_controller(self, ask_privilege: bool = False) -> ControllerReading:
        """How the controller is now.

        Args:
            ask_privilege: In manual mode, ask the operator to let this PC write, and keep asking for it.

        Raises:
            LinkError: It cannot be read.
        """
        ...

    def read_events(self) -> tuple[ControllerEvent, ...]:
        """Entries of the event log since the last call, oldest first; the first call gives none.

        Raises:
            LinkError: They cannot be read.
        """
        ...
