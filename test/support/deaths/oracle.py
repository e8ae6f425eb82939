"""Judges at the controller's folder: whose file answered the request when the robot began to mill.

Shares no code with what it judges: it reads the folder's bytes, of the file its lines `#door` and `#run` and where its
targets lie. Seen from the door that stands in the clamp, the targets of a good file lie where those of a file of
that door lay that was looked at before.

The door in the clamp is the one that stood there when the program made the request that it then milled for. Where the
next door will stand is told before the program of this one is stopped and the clamp opens: a controller that was held
up takes this door's file in between, and mills this door with it. A program that was started for the next door makes a
request of its own before it takes anything.
"""

from __future__ import annotations

import base64
import json
import subprocess
import sys
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

LOOKOUT = Path(__file__).with_name("lookout.py")
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

    def __enter__(self) -> Oracle:
        self._lookout = subprocess.Popen(
            [sys.executable, "-I", str(LOOKOUT), str(self._home)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self._lookout.stdout is not None
        self._lookout.stdout.readline()  # it looks
        self._thread = threading.Thread(target=self._hear, args=(self._lookout.stdout,), daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Look no more; all that was seen is told."""
        assert self._lookout.stdin is not None
        self._lookout.stdin.close()
        self._thread.join()
        assert self._lookout.wait() == 0, "the lookout ended before it was told to"

    def _hear(self, lines: IO[str]) -> None:
        for line in lines:
            seen = json.loads(line)
            if "named" in seen:
                self.named.add(base64.b64decode(seen["named"]))
            else:
                asked = NEVER if seen["asked"] is None else seen["asked"]
                self.starts.append(Start(base64.b64decode(seen["start"]), asked))

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
            return f"milled without a file that answers the request; in the clamp: {stood}"
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
