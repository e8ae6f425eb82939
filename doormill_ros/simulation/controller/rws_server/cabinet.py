"""What the simulated web services give access to: HOME folder, signals, RAPID data, states.

The signals live as files in `<home>/io`, so a simulated robot program in another process that uses the
shared folder works on the same cabinet, and a change it makes becomes an event here.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path

from doormill_ros.abb import signals
from doormill_ros.files import write_atomically


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
        signals: Signals by name.
        symbols: RAPID data by path below "RAPID/", for example "T_ROB1/DoorMill/door_id".
        ctrlstate: State of the motors.
        opmode: Operating mode.
        execution: "running" or "stopped".
        mastership: True while a client holds mastership of RAPID.
    """

    home: Path
    signals: dict[str, SimulatedSignal] = field(default_factory=dict)
    symbols: dict[str, str] = field(default_factory=dict)
    ctrlstate: str = "motoron"
    opmode: str = "AUTO"
    execution: str = "running"
    mastership: bool = False

    @classmethod
    def create(cls, home: Path, table: Iterable[SimulatedSignal] | None = None) -> Cabinet:
        """A cabinet on an existing or new HOME folder."""
        (home / signals.IO_FOLDER).mkdir(parents=True, exist_ok=True)
        table = default_signals() if table is None else table
        return cls(home, {signal.name: signal for signal in table})

    def find_signal(self, path: str) -> SimulatedSignal | None:
        """The signal at `{network}/{device}/{name}` or just `{name}`."""
        signal = self.signals.get(path.rsplit("/", 1)[-1])
        return signal if signal is not None and path in (signal.path, signal.name) else None

    def value(self, name: str) -> int:
        """The signal's level, 0 when its file is missing or torn."""
        try:
            return int((self.home / signals.IO_FOLDER / name).read_bytes().strip() == signals.HIGH)
        except OSError:
            return 0

    def set_value(self, name: str, value: int) -> None:
        """Replace the signal's file in one step."""
        write_atomically(self.home / signals.IO_FOLDER / name, signals.HIGH if value else signals.LOW)
