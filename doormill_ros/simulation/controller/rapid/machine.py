"""The seam between the RAPID interpreter and the controller around it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from doormill_ros.simulation.controller.rapid.types import Value


@dataclass(frozen=True)
class Move:
    r"""A motion instruction as the program gives it, in RAPID's values and units.

    Attributes:
        kind: "MoveJ", "MoveL", "MoveC" or "MoveAbsJ".
        target: robtarget, or jointtarget for MoveAbsJ.
        via: Circle point of MoveC, else None.
        speed: speeddata.
        zone: zonedata.
        tool: tooldata.
        wobj: wobjdata.
        duration: `\T` in seconds, None without it.
        file: Module file of the instruction.
        line: Its line.
    """

    kind: str
    target: Value
    via: Value | None
    speed: Value
    zone: Value
    tool: Value
    wobj: Value
    duration: float | None
    file: str
    line: int


class Machine(Protocol):
    """What a RAPID program can reach outside itself."""

    @property
    def home(self) -> Path:
        """Folder behind HOME:."""
        ...

    def signal_kinds(self) -> dict[str, str]:
        """Configured signals: name to "signaldi", "signaldo", "signalai" or "signalao"."""
        ...

    def read_signal(self, name: str) -> float:
        """Present value of a signal."""
        ...

    def write_signal(self, name: str, value: float) -> None:
        """Set an output."""
        ...

    def now(self) -> float:
        """Simulated time [s]."""
        ...

    def statement(self, file: str, line: int) -> None:
        """Called before each statement; raises RapidStop to end the program."""
        ...

    def wait(self, condition: Callable[[], bool] | None, seconds: float | None) -> bool:
        """Let time pass until the condition holds (True) or the seconds are over (False)."""
        ...

    def move(self, move: Move) -> None:
        """Take a motion; returns when the program pointer may go on."""
        ...

    def wait_in_position(self) -> None:
        """Let time pass until the robot stands still at its last target."""
        ...

    def stop_motion(self, clear: bool) -> None:
        """Stop the robot on its path; `clear` forgets the motions that are left."""
        ...

    def restart_motion(self) -> None:
        """Go on with stopped motions."""
        ...

    def supervise_configuration(self, linear: bool, on: bool) -> None:
        """ConfL or ConfJ, on or off."""
        ...

    def current_joints(self) -> list[float]:
        """Joint angles where the robot stands [deg]."""
        ...

    def current_target(self, tool: Value, wobj: Value) -> Value:
        """Robtarget where the robot stands."""
        ...

    def pendant(self, text: str) -> None:
        """Show a line on the pendant."""
        ...

    def log(self, kind: str, title: str, text: str) -> None:
        """Add to the event log; kind is "information", "warning" or "error"."""
        ...
