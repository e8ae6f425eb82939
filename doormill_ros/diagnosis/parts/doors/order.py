"""Doors in the order in which they were milled: a pallet may be gauged from its last door on, or under one stamp."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

from doormill_ros.diagnosis.core.times import growing
from doormill_ros.diagnosis.parts.doors.gauged_door import GaugedDoor


def in_order(doors: Sequence[GaugedDoor]) -> list[GaugedDoor]:
    """Doors as they were milled, with times that grow from each to the next.

    Bags order them, and where one tells no moment, or one run stands for several doors, the gauge and then their names.
    A gauge that came to them in that order tells their times as well: bags of a simulated cell pass faster than its
    shift.

    Args:
        doors: Any number.
    """

    def gauged(door: GaugedDoor) -> tuple[float, str]:
        return door.time, door.name

    found, milled = sorted(doors, key=gauged), [door.milled for door in doors if door.milled is not None]
    if len(milled) == len(doors) == len({door.run_id for door in doors}):
        found.sort(key=lambda door: door.milled or 0.0)
        if any(before.time >= after.time for before, after in itertools.pairwise(found)):
            found = [replace(door, time=door.milled or 0.0) for door in found]
    times = growing([door.time for door in found])
    return [replace(door, time=time) for door, time in zip(found, times, strict=True)]
