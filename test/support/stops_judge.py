"""Who judges a run of stops: sees tool, spindle, guard and door, and what the robot tells the PC, nothing else.

- No feed into uncut wood with a spindle below its speed.
- A standing tool moves in the wood only where it was while it turned. Whatever shape tool and chips have, there it
  fits; beside that place teeth are drawn through wood that they stand in.
- No spindle that is told to turn while the guard is open, and no motion then.
- No cut into a door by a file that was accepted for the one before, and none into a door that nobody named.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.operation.states import OperatingMode

Cell = tuple[int, int, int]
#: Edge of the cells in which wood is counted [m].
CELL = 1e-3
#: A spindle below this share of its speed does not cut well; at-speed falls there. Below the other it stands.
AT_SPEED, STANDING = 0.9, 0.3
#: After the spindle fell below its speed a stop may take so long, after the guard opened likewise [s].
REACTION, GUARD_REACTION = 0.3, 0.6


@dataclass
class Verdict:
    """What the judge saw.

    Attributes:
        feeds: Times of feeds into wood with a spindle below its speed [s].
        strayed: Times at which a standing tool was moved in the wood where it never turned [s].
        turning: Times at which the spindle was told to turn with an open guard [s].
        moving: Times of motions with an open guard [s].
        mistaken: Times of cuts by a file that was accepted for a door that was taken out, or into a door that nobody
            named [s].
        struck: The incident happened.
        done_unmilled: A door was reported as done that was not.
        recovered: The last door was milled completely and reported as done.
        remarks: What else there is to say.
    """

    feeds: list[float] = field(default_factory=list)
    strayed: list[float] = field(default_factory=list)
    turning: list[float] = field(default_factory=list)
    moving: list[float] = field(default_factory=list)
    mistaken: list[float] = field(default_factory=list)
    struck: bool = False
    done_unmilled: bool = False
    recovered: bool = False
    remarks: list[str] = field(default_factory=list)

    @property
    def safe(self) -> bool:
        """Nothing was broken and nobody hurt."""
        return not (self.feeds or self.strayed or self.turning or self.moving or self.mistaken)

    @property
    def passed(self) -> bool:
        """Safe, and the work went on."""
        return self.safe and self.recovered and not self.done_unmilled and self.struck


@dataclass(frozen=True, eq=False)
class Wood:
    """The wood of a door.

    Attributes:
        T_base_door: Where it stands, shape (4, 4).
        size: Its extents along its axes, shape (3,) [m].
        cut: Cells through which the tool centre point cuts when nothing stops it; empty when nobody knows.
    """

    T_base_door: FloatArray
    size: FloatArray
    cut: frozenset[Cell] = frozenset()

    def holds(self, point: FloatArray) -> bool:
        """Whether a point of the base frame, shape (3,) [m], is within the door."""
        own = self.T_base_door[:3, :3].T @ (point - self.T_base_door[:3, 3])
        return bool((own > 0.0).all() and (own < self.size).all())


def cell_of(point: FloatArray) -> Cell:
    """The cell of a point, shape (3,) [m]."""
    x, y, z = np.floor(point / CELL).astype(int)
    return int(x), int(y), int(z)


_AROUND = [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]


def grown(cells: Iterable[Cell]) -> set[Cell]:
    """The cells and their neighbours."""
    return {(x + i, y + j, z + k) for x, y, z in cells for i, j, k in _AROUND}


class Judge:
    """Watches tool, spindle and guard."""

    def __init__(
        self, robot: VirtualController, verdict: Verdict, wood: Wood, accepted: Callable[[], int]
    ) -> None:
        """Judge into a verdict.

        Args:
            robot: The robot.
            verdict: Where it is written.
            wood: What is to be cut.
            accepted: Number of the file that the robot said last that it accepted, 0 for none.
        """
        self._robot, self._verdict, self._wood, self._accepted = robot, verdict, wood, accepted
        self._near = grown(wood.cut)
        self._seen, self._time, self._share = 0, 0.0, 0.0
        self._slow_since: float | None = 0.0
        self._open_since: float | None = None
        self._stale = 0
        #: Somebody named the door that is in the clamp.
        self.named = True
        self.cut: set[Cell] = set()

    def new_door(self, offered: int, named: bool = True) -> None:
        """Another door stands there, all of its wood uncut; the files up to a number were for others."""
        self.cut.clear()
        self._stale, self.named = offered, named

    def complete(self) -> bool:
        """Whether all that should be milled of the present door is."""
        return self._wood.cut <= grown(self.cut)

    def watch(self) -> None:
        """Look at what has happened since the last look."""
        robot, now = self._robot, self._robot.now()
        cell = robot.cell
        told = cell.read(cell.spindle_drive) == 1.0
        step, self._time = now - self._time, now
        change = step / cell.spindle_time
        self._share = float(
            np.clip(self._share + (change if told and cell.spindle_works else -change), 0.0, 1.0)
        )
        if self._share >= AT_SPEED:
            self._slow_since = None
        elif self._slow_since is None:
            self._slow_since = now
        self._look_at_the_guard(now, told)
        recording = robot.recording
        for i in range(self._seen, len(recording.time)):
            driven = recording.driven[i]
            moved = i > 0 and np.abs(recording.q[i] - recording.q[i - 1]).max() > 1e-7
            self._look_at_the_tool(recording.time[i], recording.poses[i][:3, 3], moved and driven)
        self._seen = len(recording.time)

    def _look_at_the_guard(self, now: float, told: bool) -> None:
        if self._robot.panel.guard_closed:
            self._open_since = None
            return
        if self._open_since is None:
            self._open_since = now
        if now - self._open_since <= GUARD_REACTION:
            return
        if told:
            self._verdict.turning.append(now)
        manual = self._robot.panel.state.mode is not OperatingMode.AUTO
        if self._robot.moving and not manual:
            self._verdict.moving.append(now)

    def _look_at_the_tool(self, time: float, point: FloatArray, feeding: bool) -> None:
        place = cell_of(point)
        if self._share > STANDING:
            self.cut.add(place)
            stale = self._stale and self._accepted() <= self._stale
            if place in self._near and (stale or not self.named):
                self._verdict.mistaken.append(time)
            return
        if not feeding or grown([place]) & self.cut:
            return
        slow = self._slow_since is not None and time - self._slow_since > REACTION
        if slow and place in self._near:
            self._verdict.feeds.append(time)
        if self._wood.holds(point):
            self._verdict.strayed.append(time)
