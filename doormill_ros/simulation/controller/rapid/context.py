"""The state of a running RAPID program that is not its data."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from doormill_ros.simulation.controller.rapid.interrupts import Interrupts
from doormill_ros.simulation.controller.rapid.machine import Machine


@dataclass(eq=False)
class Context:
    """State of a running program that is not its data."""

    machine: Machine
    file: str = ""
    line: int = 0
    depth: int = 0
    #: ERRNO, as the list of one that the symbol refers to.
    errno: list[float] = field(default_factory=lambda: [0.0])
    #: Error numbers handed out by BookErrNo; the controller's own begin far above.
    booked_errors: int = 0
    #: What the event log will say of an error that an ERROR clause has taken; SkipWarn empties it.
    warning: str = ""
    #: Open files, to be closed when the program ends.
    devices: list[Any] = field(default_factory=list)
    interrupts: Interrupts = field(init=False)

    def __post_init__(self) -> None:
        """Set the interrupts up, and have the machine look after them."""
        self.interrupts = Interrupts(self.machine)
        self.machine.set_attendant(self.interrupts)
