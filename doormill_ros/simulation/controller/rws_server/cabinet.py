"""What the simulated web services give access to: folders, signals, and the controller itself.

The levels of the handshake's signals are behind an `IoPort`. When that is the port of a simulated controller, or the
folder that one uses from another process, a change that its program makes becomes an event here. All other signals,
data and states are the controller's own.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from doormill_ros.abb import signals
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo, IoPort
from doormill_ros.simulation.controller.configuration.io_configuration import ACCESS_LEVELS, SignalAccess
from doormill_ros.simulation.controller.rapid.errors import SignalError
from doormill_ros.simulation.controller.rws_server.served import IdleController, ServedController

#: Network and device under which clients look for a signal that has none; the controller opens it by its name.
LOCAL_DEVICE = "Local/DRV_1"
_OF_THE_PORT = signals.ALL_SIGNALS + signals.GROUP_SIGNALS


@dataclass(frozen=True)
class SimulatedSignal:
    """A signal of the controller.

    Attributes:
        name: Its name.
        access: Who may write it; a web client counts as remote.
        network: I/O network, "" for a virtual signal.
        device: Device on that network.
        kind: "DI", "DO", "AI", "AO", "GI" or "GO".
        largest: Largest value.
    """

    name: str
    access: SignalAccess = ACCESS_LEVELS["Default"]
    network: str = ""
    device: str = ""
    kind: str = "DO"
    largest: float = 1.0

    @property
    def path(self) -> str:
        """The signal's place in the web services' tree."""
        return "/".join(part for part in (self.network, self.device, self.name) if part)


def default_signals() -> tuple[SimulatedSignal, ...]:
    """The handshake's signals; only those of the PC may be written from outside."""
    ready = SimulatedSignal(signals.READY, ACCESS_LEVELS["All"])
    numbers = (
        SimulatedSignal(name, ACCESS_LEVELS["All"], kind="GO", largest=signals.LARGEST_NUMBER)
        for name in signals.GROUP_SIGNALS
    )
    return (ready, *numbers, *(SimulatedSignal(name) for name in signals.CONTROLLER_SIGNALS))


@dataclass
class Cabinet:
    """What is behind the web services.

    Attributes:
        home: The controller's HOME folder.
        io: Who holds the levels of the handshake's signals.
        signals: Signals by name.
        controller: The controller; an idle one when no program runs behind the services.
        answers_privilege: What the operator answers to a request for the remote privilege: "GRANTED", "DENIED", or
            "PENDING" while nobody answers.
    """

    home: Path
    io: IoPort
    signals: dict[str, SimulatedSignal] = field(default_factory=dict)
    controller: ServedController = field(default_factory=IdleController)
    answers_privilege: str = "PENDING"

    def __post_init__(self) -> None:
        """Make the RAM disk."""
        self._ramdisk = tempfile.TemporaryDirectory(prefix="simulated-ramdisk-")

    @classmethod
    def create(
        cls,
        home: Path,
        table: Iterable[SimulatedSignal] | None = None,
        io: IoPort | None = None,
        controller: ServedController | None = None,
    ) -> Cabinet:
        """A cabinet on an existing or new HOME folder.

        Args:
            home: The folder.
            table: The signals; None for those of the handshake.
            io: Who holds the levels of the handshake's signals; None for files in `<home>/io`.
            controller: The controller; None for an idle one.
        """
        table = tuple(default_signals() if table is None else table)
        return cls(
            home,
            FolderIo(home) if io is None else io,
            {signal.name: signal for signal in table},
            IdleController() if controller is None else controller,
        )

    @property
    def idle(self) -> IdleController:
        """The idle controller, for tests that set what it says.

        Raises:
            TypeError: A program runs behind the services.
        """
        if not isinstance(self.controller, IdleController):
            raise TypeError("a program runs behind these services: set its own state")
        return self.controller

    @property
    def ramdisk(self) -> Path:
        """The folder behind RAMDISK:."""
        return Path(self._ramdisk.name)

    def find_signal(self, path: str) -> SimulatedSignal | None:
        """The signal at `{network}/{device}/{name}`, at the local device, or just by its name."""
        signal = self.signals.get(path.rsplit("/", 1)[-1])
        if signal is None:
            return None
        return signal if path in (signal.path, signal.name, f"{LOCAL_DEVICE}/{signal.name}") else None

    def value(self, name: str) -> float:
        """The signal's level, 0 when it cannot be read."""
        try:
            if name in _OF_THE_PORT:
                return self.io.read(name)
            return self.controller.read_signal(name)
        except SignalError:
            return 0

    def set_value(self, name: str, value: float) -> None:
        """Set the signal."""
        if name in _OF_THE_PORT:
            self.io.write(name, int(value))
        else:
            self.controller.write_signal(name, value)
