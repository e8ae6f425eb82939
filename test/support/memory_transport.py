"""A transport within one process, for a simulated controller beside the cell and for tests."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Iterable

from doormill_ros.abb import signals
from doormill_ros.abb.link_errors import FileMissingError, UnknownSignalError
from doormill_ros.abb.transport import check_file_name


class MemoryTransport:
    """Signals and files in memory; the controller's side uses `set_signal`, `signal` and `read_file`."""

    in_doubt_time = 0.0

    def __init__(self, absent: Iterable[str] = ()) -> None:
        """All signals low, no files; the controller has none of the absent signals."""
        self._absent = frozenset(absent)
        self.closed = False
        self._mutex = threading.Lock()
        self._levels = dict.fromkeys(signals.ALL_SIGNALS, False)
        self._numbers: dict[str, int] = {}
        self._files: dict[str, bytes] = {}
        self._edges: deque[bool] = deque()
        self._woken = threading.Event()

    def signal(self, name: str) -> bool:
        """The controller's view of a signal."""
        with self._mutex:
            return self._levels[name]

    def set_signal(self, name: str, value: bool) -> None:
        """The controller writes a signal."""
        with self._mutex:
            if name == signals.REQUEST and self._levels[name] != value:
                self._edges.append(value)
            self._levels[name] = value
        self._woken.set()

    def read_request(self) -> bool:
        """The next edge of the request, or its level."""
        with self._mutex:
            return self._edges.popleft() if self._edges else self._levels[signals.REQUEST]

    def read_ready(self) -> bool:
        """The ready signal."""
        return self.signal(signals.READY)

    def read_signal(self, name: str) -> bool:
        """Any signal."""
        self._require(name)
        return self.signal(name)

    def set_ready(self, value: bool) -> None:
        """Write the ready signal."""
        with self._mutex:
            self._levels[signals.READY] = value

    def read_number(self, name: str) -> int:
        """A group signal, 0 before it is written."""
        self._require(name)
        with self._mutex:
            return self._numbers.get(name, 0)

    def write_number(self, name: str, value: int) -> None:
        """Write a group signal, from either side."""
        self._require(name)
        with self._mutex:
            self._numbers[name] = value
        self._woken.set()

    def write_file(self, name: str, data: bytes) -> None:
        """Keep the bytes."""
        with self._mutex:
            self._files[check_file_name(name)] = bytes(data)

    def read_file(self, name: str) -> bytes:
        """The bytes kept under that name."""
        with self._mutex:
            if name not in self._files:
                raise FileMissingError(f"{name} does not exist; write it first", file=name)
            return self._files[name]

    def remove_file(self, name: str) -> None:
        """Forget the bytes."""
        with self._mutex:
            self._files.pop(name, None)

    def wait(self, timeout: float) -> None:
        """Sleep until the controller writes a signal."""
        if self._woken.wait(max(0.0, timeout)):
            self._woken.clear()

    def wake(self) -> None:
        """End a `wait`."""
        self._woken.set()

    def close(self) -> None:
        """Nothing to give back."""
        self.closed = True

    def _require(self, name: str) -> None:
        if name in self._absent:
            raise UnknownSignalError(f"the controller has no signal {name}", signal=name)
