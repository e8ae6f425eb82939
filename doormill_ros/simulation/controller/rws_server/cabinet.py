"""What the simulated web services give access to: HOME folder, signals, RAPID data, states.

The levels of the signals are behind an `IoPort`. When that is the port of a simulated controller, or the
folder that one uses from another process, a change that its program makes becomes an event here.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path

from doormill_ros.abb import signals
from doormill_ros.simulation.controller.io_port import FolderIo, IoPort
from doormill_ros.simulation.controller.rapid.errors import SignalError


class AccessLevel(str, Enum):
    """Who may write a signal, as configured on the controller."""

    ALL = "All"
    DEFAULT = "Default"
    READ_ONLY = "ReadOnly"


@dataclass(frozen=True)
class SimulatedSignal:
    """A digital output.

    Attributes:
        name: Its name.
        access: Only "All" lets a web client write it.
        network: I/O network, "" for a virtual signal.
        device: Device on that network.
    """

    name: str
    access: AccessLevel = AccessLevel.DEFAULT
    network: str = ""
    device: str = ""

    @property
    def path(self) -> str:
        """The signal's place in the web services' tree."""
        return "/".join(part for part in (self.network, self.device, self.name) if part)


def default_signals() -> tuple[SimulatedSignal, ...]:
    """The handshake's signals; only READY may be written from outside."""
    ready = SimulatedSignal(signals.READY, AccessLevel.ALL)
    return (ready, *(SimulatedSignal(name) for name in signals.CONTROLLER_SIGNALS))


@dataclass
class Cabinet:
    """State behind the web services.

    Attributes:
        home: The controller's HOME folder.
        io: Who holds the signals' levels.
        signals: Signals by name.
        symbols: RAPID data by path below "RAPID/", for example "T_ROB1/DoorMill/door_id".
        ctrlstate: State of the motors.
        opmode: Operating mode.
        execution: "running" or "stopped".
        mastership: True while a client holds mastership of RAPID.
    """

    home: Path
    io: IoPort
    signals: dict[str, SimulatedSignal] = field(default_factory=dict)
    symbols: dict[str, str] = field(default_factory=dict)
    ctrlstate: str = "motoron"
    opmode: str = "AUTO"
    execution: str = "running"
    mastership: bool = False

    @classmethod
    def create(
        cls, home: Path, table: Iterable[SimulatedSignal] | None = None, io: IoPort | None = None
    ) -> Cabinet:
        """A cabinet on an existing or new HOME folder.

        Args:
            home: The folder.
            table: The signals; None for those of the handshake.
            io: Who holds their levels; None for files in `<home>/io`.
        """
        table = tuple(default_signals() if table is None else table)
        return cls(
            home,
            FolderIo(home, [signal.name for signal in table]) if io is None else io,
            {signal.name: signal for signal in table},
        )

    def find_signal(self, path: str) -> SimulatedSignal | None:
        """The signal at `{network}/{device}/{name}` or just `{name}`."""
        signal = self.signals.get(path.rsplit("/", 1)[-1])
        return signal if signal is not None and path in (signal.path, signal.name) else None

    def value(self, name: str) -> int:
        """The signal's level, 0 when it cannot be read."""
        try:
            return self.io.read(name)
        except SignalError:
            return 0

    def set_value(self, name: str, value: int) -> None:
        """Set the signal."""
        self.io.write(name, value)
