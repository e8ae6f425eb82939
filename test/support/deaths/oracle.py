"""Judges at the controller's folder: whose file stood under a high ready signal when the robot began to mill.

Shares no code with what it judges: it reads the folder's bytes, of the file its lines `#door` and `#run` and where its
targets lie. Seen from the door that stands in the clamp, the targets of a good file lie where those of a file of
that door lay that was looked at before.

The door in the clamp is the one that stood there when the program made the request that it then milled for. Where the
next door will stand is told before the program of this one is stopped and the clamp opens: a controller that was held
up takes this door's file in between, and mills this door with it. A program that was started for the next door makes a
request of its own before it takes anything.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

LOOK = 0.001  # s
FIRST = -15  #: niceness of the thread that looks
NEVER = float("-inf")
#: Between the targets of two good files of a door, seen from the door [m]: the pose is found to 0.1 mm, and the
#: correction differs with the robot's posture. Doors of the campaign stand up to 8 mm and 0.03 rad apart.
PLACE = 1e-3


@dataclass(frozen=True)
class Start:
    """The robot began to mill the file that stood there; `asked` when it was requested [s since the epoch]."""

    data: bytes
    asked: float


@dataclass(frozen=True)
class Place:
    """Where a door stands in the robot's base: origin [m], quaternion x, y, z, w."""

    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turn: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)

    def seen(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points of the base (N, 3), seen from the door [m]."""
        x, y, z, w = self.turn
        axes = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )
        return (points - np.array(self.origin)) @ axes


@dataclass(frozen=True)
class Placed:
    """A door was clamped [s since the epoch]."""

    at: float
    door_id: str
    run_id: str
    place: Place = Place()


def targets_of(data: bytes) -> NDArray[np.float64]:
    """Positions of a target file's targets (N, 3) [m]."""
    lines = [line for line in data.decode("ascii", "replace").splitlines() if line and line[0] != "#"]
    return (
        np.array([[float(value) for value in line.split(";")[:3]] for line in lines]).reshape(-1, 3) / 1000.0
    )


class Oracle:
    """Watches the signals; `placed` is told by whoever hears the placements, in any order and at any time.

    Args:
        home: The controller's folder.
        good: By door, where the targets of a good file lie, seen from the door (N, 3) [m].
    """

    def __init__(self, home: Path, good: Mapping[str, NDArray[np.float64]]) -> None:
        self._home = home
        self._good = good
        self._placed: list[Placed] = []
        self.starts: list[Start] = []
        #: What the controller named as milled to its end; stands for as long as no other run was.
        self.named: set[bytes] = set()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> Oracle:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def placed(self, placed: Placed) -> None:
        """A door stands in the clamp."""
        self._placed.append(placed)

    def faults(self) -> list[str]:
        """What was milled that did not stand there."""
        return [fault for fault in map(self._fault, self.starts) if fault]

    def places(self) -> int:
        """Different places at which doors stood when the robot began."""
        return len({stood.place for stood in map(self._stood, self.starts) if stood})

    def _stood(self, start: Start) -> Placed | None:
        return max((p for p in self._placed if p.at <= start.asked), key=lambda p: p.at, default=None)

    def _fault(self, start: Start) -> str:
        stood = self._stood(start)
        if not start.data:
            return f"milled without a file under a high ready; in the clamp: {stood}"
        named: dict[str, str] = {}
        for line in start.data.decode("ascii", "replace").splitlines():
            key, _, value = line.partition(" ")
            named.setdefault(key, value)
        found = named.get("#door"), named.get("#run")
        if stood is None or found != (stood.door_id, stood.run_id):
            own = [f"{p.at:.3f}" for p in self._placed if (p.door_id, p.run_id) == found]
            return f"milled {found}, requested at {start.asked:.3f}, clamped at {own}; in the clamp: {stood}"
        seen, good = stood.place.seen(targets_of(start.data)), self._good[stood.door_id]
        if seen.shape != good.shape:
            return f"milled {found} by {len(seen)} targets instead of {len(good)}; in the clamp: {stood}"
        off = float(np.linalg.norm(seen - good, axis=1).max())
        return f"milled {found} {1000.0 * off:.2f} mm off; in the clamp: {stood}" if off > PLACE else ""

    def _read(self, path: Path) -> bytes:
        try:
            return path.read_bytes()
        except OSError:
            return b""

    def _is_high(self, signal: Path) -> bool:
        return self._read(signal).strip() == b"1"

    def _asked(self) -> float:
        """When the program wrote the number of its request, by the machine's own clock; -inf for never."""
        try:
            return (self._home / "Hei2.req").stat().st_mtime
        except OSError:
            return NEVER

    def _watch(self) -> None:
        with suppress(PermissionError):  # without the right to it, it may look too late on a machine at work
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), FIRST)
        ready, busy, target = (
            self._home / "io" / "doPathReady",
            self._home / "io" / "doPathBusy",
            self._home / "Hei2.txt",
        )
        was_busy, kept = True, Start(b"", NEVER)
        while not self._ended.is_set():
            # Ready was high before the file was read and after it, for one request: no write of the PC was met halfway.
            if self._is_high(ready):
                asked, data = self._asked(), self._read(target)
                if data and self._is_high(ready) and self._asked() == asked:
                    kept = Start(data, asked)
            self.named.add(self._read(self._home / "Hei2.end"))
            is_busy = self._is_high(busy)
            if is_busy and not was_busy:
                self.starts.append(kept)
                kept = Start(b"", NEVER)
            was_busy = is_busy
            time.sleep(LOOK)
