"""The signals between the controller and the PC as the controller side sees them."""

from __future__ import annotations

import threading
import time
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Protocol

from doormill_ros.abb.signals import ALL_SIGNALS, GROUP_SIGNALS, IO_FOLDER, LARGEST_NUMBER
from doormill_ros.files import write_atomically
from doormill_ros.simulation.controller.rapid.errors import SignalError

#: Largest values of the handshake's groups.
GROUPS = dict.fromkeys(GROUP_SIGNALS, LARGEST_NUMBER)


class IoPort(Protocol):
    """Digital and group signals by name; safe to use from several threads.

    The RAPID program, a simulated folder and the web services are joined by one port that all of them use.
    """

    def read(self, name: str) -> int:
        """0 or 1, more for a group; a signal that nobody wrote is 0.

        Raises:
            SignalError: No such signal, or its value cannot be read.
        """
        ...

    def write(self, name: str, value: int) -> None:
        """Set a signal to 0 or 1, a group to what it holds.

        Raises:
            SignalError: No such signal, another value, or it cannot be written.
        """
        ...


class _Known:
    """The signals of a port: their names, and the largest value of the groups among them."""

    def __init__(self, names: Collection[str], largest: Mapping[str, int]) -> None:
        self.names = (*names, *(name for name in largest if name not in names))
        self._largest = dict(largest)

    def check(self, name: str, value: int = 0) -> None:
        """Refuse names and values that are not configured.

        Raises:
            SignalError: Names what was found and what is allowed.
        """
        if name not in self.names:
            raise SignalError(
                f"signal {name!r} does not exist, allowed are {', '.join(self.names)}: correct the name",
                name=name,
            )
        if not self.holds(name, value):
            raise SignalError(
                f"signal {name} cannot become {value!r}, allowed are {self.allowed(name)}",
                name=name,
                value=value,
            )

    def holds(self, name: str, value: int) -> bool:
        """Whether a signal can have a value."""
        return value in range(self._largest.get(name, 1) + 1)

    def allowed(self, name: str) -> str:
        """The values of a signal, for messages."""
        return f"0 to {self._largest[name]}" if name in self._largest else "'0' and '1'"


class MemoryIo:
    """Signals in this process."""

    def __init__(self, names: Collection[str] = ALL_SIGNALS, largest: Mapping[str, int] = GROUPS) -> None:
        """Start with every signal low.

        Args:
            names: The signals.
            largest: Group signals and the largest value of each.
        """
        self._known = _Known(names, largest)
        self._values = dict.fromkeys(self._known.names, 0)
        self._lock = threading.Lock()
        #: Every change as (name, value), for tests and displays.
        self.history: list[tuple[str, int]] = []

    def read(self, name: str) -> int:
        """0 or 1, more for a group."""
        self._known.check(name)
        with self._lock:
            return self._values[name]

    def write(self, name: str, value: int) -> None:
        """Set a signal."""
        self._known.check(name, value)
        with self._lock:
            if self._values[name] != value:
                self.history.append((name, value))
            self._values[name] = value


class FolderIo:
    """Signals as files `<folder>/io/<signal>` holding "0" or "1", a group its number, replaced in one step."""

    #: A writer that does not replace its file can be met between truncation and content.
    TORN_READS = 5
    TORN_PAUSE = 0.002  # s

    def __init__(
        self,
        folder: str | Path,
        names: Collection[str] = ALL_SIGNALS,
        largest: Mapping[str, int] = GROUPS,
    ) -> None:
        """Use the folder that is the controller's HOME; its `io` folder is created.

        Args:
            folder: HOME.
            names: The signals.
            largest: Group signals and the largest value of each.
        """
        self._known = _Known(names, largest)
        self._folder = Path(folder) / IO_FOLDER
        self._folder.mkdir(parents=True, exist_ok=True)

    def read(self, name: str) -> int:
        """0 or 1, more for a group; a missing file is 0."""
        self._known.check(name)
        content = b""
        for _ in range(self.TORN_READS):
            try:
                content = (self._folder / name).read_bytes().strip()
            except FileNotFoundError:
                return 0
            except OSError as error:
                raise SignalError(f"signal {name} cannot be read: {error.strerror}", name=name) from error
            if content.isdigit() and self._known.holds(name, int(content)):
                return int(content)
            time.sleep(self.TORN_PAUSE)
        raise SignalError(
            f"signal {name} holds {content[:20]!r}, allowed are {self._known.allowed(name)}: repair the file in "
            f"{self._folder}",
            name=name,
        )

    def write(self, name: str, value: int) -> None:
        """Replace the signal's file."""
        self._known.check(name, value)
        try:
            write_atomically(self._folder / name, str(int(value)).encode())
        except OSError as error:
            raise SignalError(f"signal {name} cannot be written: {error.strerror}", name=name) from error
