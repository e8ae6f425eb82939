"""Judges at the controller's folder: whose file stood under a high ready signal when the robot began to mill.

Shares no code with what it judges: it reads the folder's bytes, and of the file its lines `#door` and `#run`.
"""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass
from pathlib import Path

LOOK = 0.001  # s


@dataclass(frozen=True)
class Start:
    """The robot began to mill the file that stood there; `at` when ready was last seen high [s since the epoch]."""

    data: bytes
    at: float


@dataclass(frozen=True)
class Placed:
    """A door was clamped [s since the epoch]."""

    at: float
    door_id: str
    run_id: str


class Oracle:
    """Watches the signals; `placed` is told by whoever hears the placements, in any order and at any time."""

    def __init__(self, home: Path) -> None:
        self._home = home
        self._placed: list[Placed] = []
        self.starts: list[Start] = []
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> Oracle:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def placed(self, at: float, door_id: str, run_id: str) -> None:
        """A door stands in the clamp from a time on [s since the epoch]."""
        self._placed.append(Placed(at, door_id, run_id))

    def faults(self) -> list[str]:
        """What was milled that did not stand there."""
        return [fault for fault in map(self._fault, self.starts) if fault]

    def _fault(self, start: Start) -> str:
        stood = max((p for p in self._placed if p.at <= start.at), key=lambda p: p.at, default=None)
        if not start.data:
            return f"milled without a file under a high ready; in the clamp: {stood}"
        named: dict[str, str] = {}
        for line in start.data.decode("ascii", "replace").splitlines():
            key, _, value = line.partition(" ")
            named.setdefault(key, value)
        found = named.get("#door"), named.get("#run")
        if stood is None or found != (stood.door_id, stood.run_id):
            return f"milled {found}; in the clamp: {stood}"
        return ""

    def _read(self, path: Path) -> bytes:
        try:
            return path.read_bytes()
        except OSError:
            return b""

    def _watch(self) -> None:
        ready, busy, target = (
            self._home / "io" / "doPathReady",
            self._home / "io" / "doPathBusy",
            self._home / "Hei2.txt",
        )
        was_busy, kept, at = True, b"", 0.0
        while not self._ended.is_set():
            # The file first: it was there when ready is found high after it.
            data = self._read(target)
            if data and self._read(ready).strip() == b"1":
                kept, at = data, time.time()
            is_busy = self._read(busy).strip() == b"1"
            if is_busy and not was_busy:
                self.starts.append(Start(kept, at))
                kept = b""
            was_busy = is_busy
            time.sleep(LOOK)
