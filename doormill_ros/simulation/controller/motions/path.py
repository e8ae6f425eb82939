"""The path that a robot has before it: motions joined by corners, and where on it the robot is."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice

import numpy as np

from doormill_ros.simulation.controller.motions.stretches import Stretch, Stretches
from doormill_ros.simulation.controller.motions.track import PathNode, SpeedRules, split
from doormill_ros.simulation.controller.moves import MotionContext, PlannedMove
from doormill_ros.simulation.controller.records.recording import Sampling


@dataclass(eq=False)
class Path:
    """A path that is being driven.

    Attributes:
        row: Its nodes.
        head: Index of the node that was passed last.
        elapsed: Time since then [s], without `stood`, the time stood there [s].
        last: The motion at its end when that can still be rounded into a next one, from the node `leave` on.
    """

    row: list[PathNode]
    head: int = 0
    elapsed: float = 0.0
    stood: float = 0.0
    last: PlannedMove | None = None
    leave: PathNode | None = None

    @property
    def at_end(self) -> bool:
        """True when nothing of it is left."""
        if not self.row:
            return True
        return self.head >= len(self.row) - 1 and self.stood >= self.row[-1].dwell - 1e-12

    def until_next(self, rules: SpeedRules, rest: PathNode | None) -> float:
        """Time until the robot is in the next motion, stands, or passes `rest` [s]."""
        row, here = self.row, self.row[self.head]
        serial = here.serial
        total = max(here.dwell - self.stood, 0.0) - self.elapsed
        for there in islice(row, self.head + 1, None):
            total += rules.time_between(here, there)
            if there.serial != serial or there is rest or there.dwell > 0.0:
                total += there.dwell if there is row[-1] else 0.0
                break
            here = there
        return total

    def time_to(self, target: PathNode, rules: SpeedRules) -> float:
        """Time until the robot passes a node of the path [s]; negative when it has."""
        here = self.row[self.head]
        total = max(here.dwell - self.stood, 0.0) - self.elapsed
        for there in islice(self.row, self.head + 1, None):
            if here is target:
                return total
            total += rules.time_between(here, there)
            here = there
        return total if self.row[-1] is target else -1.0

    def divide(self, rules: SpeedRules) -> bool:
        """Put a node where the robot is on the way between two; False when it is at a node."""
        if self.elapsed <= 0.0 or self.head >= len(self.row) - 1:
            return False
        here, there = self.row[self.head], self.row[self.head + 1]
        whole = rules.time_between(here, there)
        gain = (there.speed - here.speed) / whole if whole > 0.0 else 0.0
        way = here.speed * self.elapsed + 0.5 * gain * self.elapsed**2
        share = way / here.way if here.speed + there.speed > 0.0 else self.elapsed / whole
        middle = split(here, there, float(np.clip(share, 0.0, 1.0)))
        middle.speed = here.speed + gain * self.elapsed
        self.row.insert(self.head + 1, middle)
        self.head, self.elapsed, self.stood = self.head + 1, 0.0, 0.0
        return True

    def brake(self, deceleration: float) -> PathNode | None:
        """Slow down from the node of the robot on [m/s^2]; gives where it comes to rest, None when it stands."""
        for k in range(self.head, len(self.row) - 1):
            here, there = self.row[k], self.row[k + 1]
            if here.speed == 0.0:
                return None if k == self.head else here
            left = here.speed**2 - 2.0 * deceleration * here.way
            if left <= 0.0:
                middle = split(here, there, here.speed**2 / (2.0 * deceleration * here.way))
                self.row.insert(k + 1, middle)
                return middle
            there.speed = min(there.speed, float(np.sqrt(left)))
        return self.row[-1]


class PathBuilder:
    """Adds planned motions to a path."""

    def __init__(self, rules: SpeedRules, stretches: Stretches, sampling: Sampling) -> None:
        """Build paths under these rules."""
        self._rules, self._stretches, self._sampling = rules, stretches, sampling

    def add(self, path: Path, move: PlannedMove, serial: int) -> PlannedMove | None:
        """Add a motion; gives the one whose zone becomes a stop point for it, None when all is well.

        Args:
            path: Has at least the node where the robot is.
            move: Starts where the path ends.
            serial: Its number.
        """
        enter, failed = 0.0, None
        limits, last, leave = self._rules.limits, path.last, path.leave
        if last is not None and leave is not None:
            if move.length > 0.0 and path.time_to(leave, self._rules) >= limits.planning_time:
                enter = self._round(path, last, leave, move, serial)
            elif move.length > 0.0 or limits.zero_length:
                failed = last
        path.last = path.leave = None
        rounded = move.zone > 0.0 and move.length > 0.0
        out = max(1.0 - _share(move.zone, move), enter) if rounded else 1.0
        along = self._stretches.along(move, enter, out, path.row[-1].q)
        self._append(path, along, move.context, serial)
        if rounded:
            path.last, path.leave = move, path.row[-1]
            tail = self._stretches.along(move, out, 1.0, path.row[-1].q)
            self._append(path, tail, move.context, serial)
        elif move.zone > 0.0 and limits.zero_length:
            failed = move
        end = path.row[-1]
        end.stop, end.dwell = True, 0.0 if move.zone > 0.0 else self._sampling.settling
        if move.length == 0.0:
            end.dwell += move.duration  # turning or waiting in place takes its time
        return failed

    def _round(self, path: Path, last: PlannedMove, leave: PathNode, move: PlannedMove, serial: int) -> float:
        """Replace the end of the motion before by a corner; gives where the new motion is entered."""
        radius = min(_share(last.zone, last) * last.length, 0.5 * move.length)
        del path.row[path.row.index(leave) + 1 :]
        leave.stop, leave.dwell = False, 0.0
        begin, end = 1.0 - _share(last.zone, last), 1.0 - radius / last.length
        if end > begin + 1e-12:
            self._append(path, self._stretches.along(last, begin, end, leave.q), last.context, serial - 1)
        corner = self._stretches.corner(last, move, radius, path.row[-1].q)
        half = len(corner.time) // 2
        # The first half of the corner belongs to the motion before it, the second to the one after.
        self._append(path, corner, [last.context] * (half + 1) + [move.context] * half, serial)
        return radius / move.length

    def _append(
        self, path: Path, stretch: Stretch, contexts: MotionContext | list[MotionContext], serial: int
    ) -> None:
        """Add samples, the first of which is the path's present end."""
        count = len(stretch.time)
        named = contexts if isinstance(contexts, list) else [contexts] * count
        made = self._rules.nodes(*stretch, named, [serial] * count)
        row = path.row
        end, first = row[-1], made[0]
        end.way, end.tool, end.programmed, end.drive = first.way, first.tool, first.programmed, first.drive
        if len(row) > 1 and not end.stop:
            self._rules.bend([row[-2], end, made[1]])
        row.extend(made[1:])


def _share(zone: float, move: PlannedMove) -> float:
    """Share of a motion that lies in its zone; at most half of the motion."""
    return min(zone / move.length, 0.5)
