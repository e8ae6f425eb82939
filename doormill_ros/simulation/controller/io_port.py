"""The signals between the controller and the PC as the controller side sees them."""

from __future__ import annotations

import threading
import time
from collections.abc import Collection
from pathlib import Path
from typing import Protocol

from doormill_ros.abb.signals import ALL_SIGNALS, HIGH, IO_FOLDER, LOW
from doormill_ros.files import write_atomically
from doormill_ros.simulation.controller.rapid.errors import SignalError


class IoPort(Protocol):
    """Digital signals by name; safe to use from several threads.

    The RAPID program, a shared folder and the web services are joined by one port that all of them use.
    """

    def read(self, name: str) -> int:
        """0 or 1; a signal that nobody wrote is 0.

        Raises:
            SignalError: No such signal, or its value cannot be read.
        """
        ...

    def write(self, name: str, value: int) -> None:
        """Set a signal to 0 or 1.

        Raises:
            SignalError: No such signal, another value, or it cannot be written.
        """
        ...


def check_signal(name: str, value: int = 0, names: Collection[str] = ALL_SIGNALS) -> None:
    """Refuse names and values that are not configured.

    Raises:
        SignalError: Names what was found and what is allowed.
    """
    if name not in names:
        raise SignalError(
            f"signal {name!r} does not exist, allowed are {', '.join(names)}: correct the name",
            name=name,
        )
    if value not in (0, 1):
        raise SignalError(
            f"signal {name} cannot become {value!r}, allowed are 0 and 1", name=name, value=value
        )


class MemoryIo:
    """Signals in this process."""

    def __init__(self) -> None:
        """Start with every signal low."""
        self._values = dict.fromkeys(ALL_SIGNALS, 0)
        self._lock = threading.Lock()
        #: Every change as (name, value), for tests and displays.
        self.history: list[tuple[str, int]] = []

    def read(self, name: str) -> int:
        """0 or 1."""
        check_signal(name)
        with self._lock:
            return self._values[name]

    def write(self, name: str, value: int) -> None:
        """Set a signal."""
        check_signal(name, value)
        with self._lock:
            if self._values[name] != value:
                self.history.append((name, value))
            self._values[name] = value


class FolderIo:
    """Signals as files `<folder>/io/<signal>` holding "0" or "1", replaced in one step."""

    #: A writer that does not replace its file can be met between truncation and content.
    TORN_READS = 5
    TORN_PAUSE = 0.002  # s

    def __init__(self, folder: str | Path, names: Collection[str] = ALL_SIGNALS) -> None:
        """Use the folder that is the controller's HOME; its `io` folder is created.

        Args:
            folder: HOME.
            names: The signals.
        """
        self._names = names
        self._folder = Path(folder) / IO_FOLDER
        self._folder.mkdir(parents=True, exist_ok=True)

    def read(self, name: str) -> int:
        """0 or 1; a missing file is 0."""
        check_signal(name, 0, self._names)
        content = b""
        for _ in range(self.TORN_READS):
            try:
                content = (self._folder / name).read_bytes().strip()
            except FileNotFoundError:
                return 0
            except OSError as error:
                raise SignalError(f"signal {name} cannot be read: {error.strerror}", name=name) from error
            if content in (LOW, HIGH):
                return int(content == HIGH)
            time.sleep(self.TORN_PAUSE)
        raise SignalError(
            f"signal {name} holds {content[:20]!r}, allowed are '0' and '1': repair the file in {self._folder}",
            name=name,
        )

    def write(self, name: str, value: int) -> None:
        """Replace the signal's file."""
        check_signal(name, value, self._names)
        try:
            write_atomically(self._folder / name, HIGH if value else LOW)
        except OSError as error:
            raise SignalError(f"signal {name} cannot be written: {error.strerror}", name=name) from error
