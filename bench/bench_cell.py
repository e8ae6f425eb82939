"""Request to ready with every node a process of its own: stage by stage, beside the floor of each stage.

`python bench/bench_cell.py` runs it alone, `--doors N` with another number of doors. Percentiles over 200 doors with
the cell idle and over 200 with one core busy, the first door of every kind in a cell that has just come up, and what
the processes hold from the twentieth door to the last. A controller that takes each file at once stands for the robot.
"""

from __future__ import annotations

import argparse
import itertools
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

import numpy as np
from door_way import STAGES, DoorWay, ways_of
from floors import dds_round_trips, disk_flush, rws_round_trip
from held import Held, size_of
from rich.console import Console
from timed_cell import TimedCell, busy_core, timed_cell

from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.units import s_to_ms
from harness import Entry, entry, exceeded, limit

DOORS = 200  #: idle, and as many with a busy core
THESIS_EXECUTION = 0.8  # s, table 4.7, a door of two hinges
TRIES = 3  #: of a first door whose bag lacks a stamp
UNTOLD = 0.05  #: of the doors milled, at most, may lack one
WARM = 20  #: doors after which the processes hold what they need
#: Request to ready [s]: of every shipped door, of those of two hinges, of the first door after the nodes are active.
MEDIAN, MOST, SMALL_MEDIAN, FIRST = 0.060, 0.090, 0.030, 0.150
SMALL = 2  #: features of a door that counts as small
UP = 2.0  # s until all nodes are active
#: What a process may take more after the last door than after the twentieth [MB].
GROWTH = 5.0
#: What one door may leave on the disk [MB]: the bag with its picture, the archived file.
DISK = 4.0
FILE_SIZE = 40_000  #: of a target file [bytes]


@dataclass(frozen=True)
class Shift:
    """What one cell showed: doors idle and busy, what it held on the way, disk a door [bytes].

    `start` and `spent` are the processor time of each process until it was up, and for an idle door [s].
    """

    idle: list[DoorWay]
    busy: list[DoorWay]
    warm: dict[str, Held]
    last: dict[str, Held]
    shared: tuple[tuple[int, int], tuple[int, int]]
    disk: float
    start: dict[str, float]
    spent: dict[str, float]
    doors: int


def run(doors: int = DOORS) -> list[Entry]:
    """Print the tables; the entries of bench.json."""
    recipes = shipped_recipes()
    console = Console(width=150)
    floor = _floors(console)
    firsts = [(way, up) for door in recipes for way, up in [_first(door)]]
    _table(console, "first door after the nodes are active", [way for way, _ in firsts], floor)
    shift = _shift(list(recipes), doors)
    _table(console, "idle", shift.idle, floor)
    _table(console, "one core busy", shift.busy, floor)
    for title, times in (("until all nodes are active", shift.start), ("an idle door", shift.spent)):
        said = ", ".join(f"{name} {s_to_ms(time):.0f}" for name, time in times.items())
        console.print(f"\nprocessor time {title} [ms]: {said}")
    entries = [_first_entry(way) for way, _ in firsts]
    entries.append(
        limit("cell: nodes active", float(np.median([up for _, up in firsts])), "s", UP, len(firsts))
    )
    for name, recipe in recipes.items():
        entries += _of_door(name, recipe, shift)
    return entries + _of_memory(shift)


def _floors(console: Console) -> dict[str, float]:
    """Of each stage that has one [s]."""
    os.environ["ROS_DOMAIN_ID"] = str(20 + (os.getpid() + 1) % 80)
    trips = dds_round_trips("standard_door")
    flush, rws = disk_flush(Path(os.environ.get("TMPDIR", "/tmp")), FILE_SIZE), rws_round_trip()
    said = [f"{name} there and back {s_to_ms(trip):.1f} ms" for name, trip in trips.items()]
    console.print(f"floors: DDS {', '.join(said)}; flush {s_to_ms(flush):.2f} ms; RWS {s_to_ms(rws):.2f} ms")
    wire = {f"{name} on the wire": 0.5 * trip for name, trip in trips.items()}
    return {**wire, "file written": flush, "read back, checked": rws, "ready": rws}


def _first(door: str) -> tuple[DoorWay, float]:
    for _ in range(TRIES):
        with timed_cell() as cell:
            cell.take(door)
            ways = _told(ways_of(_closed_bag(cell)))
            if ways:
                return ways[0], cell.up
    raise RuntimeError(f"no bag of {TRIES} tells the way of the first door {door}")


def _shift(names: Sequence[str], doors: int) -> Shift:
    """Doors in turn through one cell, idle first."""
    turn = itertools.cycle(names)
    with timed_cell() as cell:
        start = cell.processor_times()
        for _ in range(WARM):
            cell.take(next(turn))
        warm, shared, disk = cell.held(), cell.shared(), size_of(cell.folder)
        before = cell.processor_times()
        for _ in range(doors):
            cell.take(next(turn))
        spent = {name: (time - before[name]) / doors for name, time in cell.processor_times().items()}
        with busy_core(True):
            for _ in range(doors):
                cell.take(next(turn))
        last, shared_last = cell.held(), cell.shared()
        ways = ways_of(_closed_bag(cell))
        if len(ways) != WARM + 2 * doors:
            raise RuntimeError(f"the bag has {len(ways)} runs, milled were {WARM + 2 * doors} doors")
        grown = size_of(cell.folder) - disk
    idle, busy = _told(ways[WARM:-doors]), _told(ways[-doors:])
    return Shift(idle, busy, warm, last, (shared, shared_last), grown / (2 * doors), start, spent, 2 * doors)


def _closed_bag(cell: TimedCell) -> Path:
    cell.stop("bag_recorder")
    return cell.folder / "bag"


def _told(ways: list[DoorWay | str]) -> list[DoorWay]:
    """Those whose stamps are all there; what the others lack goes to the standard error."""
    for way in ways:
        if isinstance(way, str):
            print(f"left out: {way}", file=sys.stderr)
    told = [way for way in ways if isinstance(way, DoorWay)]
    if len(told) < (1.0 - UNTOLD) * len(ways) and len(ways) > 1:
        raise RuntimeError(f"the bag does not tell the way of {len(ways) - len(told)} doors of {len(ways)}")
    return told


def _table(console: Console, title: str, ways: Sequence[DoorWay], floor: dict[str, float]) -> None:
    """A row a stage, a column a kind of door: median and 95 % [ms]."""
    names = list(dict.fromkeys(way.door_id for way in ways))
    console.print(f"\n{title}, {len(ways)} doors: median / 95 % [ms]")
    console.print(f"{'':22s}{'floor':>8s}" + "".join(f"{name[:15]:>17s}" for name in names))
    for number, stage in enumerate([*STAGES, "request to ready"]):
        cells = ""
        for name in names:
            times = [
                way.stages[number] if number < len(STAGES) else way.total
                for way in ways
                if way.door_id == name
            ]
            middle, most = s_to_ms(float(np.median(times))), s_to_ms(float(np.percentile(times, 95)))
            cells += f"{f'{middle:.1f} /{most:6.1f}':>17s}"
        lowest = f"{s_to_ms(floor[stage]):8.2f}" if stage in floor else " " * 8
        console.print(f"{stage:22s}{lowest}{cells}")


def _first_entry(way: DoorWay) -> Entry:
    return limit(f"cell: first door after the nodes are active, {way.door_id}", way.total, "s", FIRST, 1)


def _of_door(name: str, recipe: Recipe, shift: Shift) -> list[Entry]:
    idle = [way.total for way in shift.idle if way.door_id == name]
    busy = [way.total for way in shift.busy if way.door_id == name]
    small = len(recipe.features) <= SMALL
    what = "cell: request to ready, separate processes"
    return [
        limit(
            f"{what}, {name}, median",
            float(np.median(idle)),
            "s",
            SMALL_MEDIAN if small else MEDIAN,
            len(idle),
        ),
        limit(f"{what}, {name}, 95 %", float(np.percentile(idle, 95)), "s", MOST, len(idle)),
        entry(
            f"{what}, {name}, median with one core busy",
            float(np.median(busy)),
            "s",
            "thesis, table 4.7, a door of two hinges",
            THESIS_EXECUTION,
            len(busy),
        ),
    ]


def _of_memory(shift: Shift) -> list[Entry]:
    """Growth from the twentieth door to the last; handles and segments are counted, none may be added."""
    entries = []
    for name, warm in shift.warm.items():
        last = shift.last[name]
        entries.append(limit(f"cell: memory, {name}", last.memory, "MB", warm.memory + GROWTH, shift.doors))
        entries.append(limit(f"cell: handles, {name}", last.handles, "handles", warm.handles, shift.doors))
        entries.append(limit(f"cell: sockets, {name}", last.sockets, "sockets", warm.sockets, shift.doors))
        entries.append(limit(f"cell: threads, {name}", last.threads, "threads", warm.threads, shift.doors))
    (segments, size), (segments_last, size_last) = shift.shared
    entries.append(limit("cell: shared memory segments", segments_last, "segments", segments, shift.doors))
    entries.append(limit("cell: shared memory", size_last / 1e6, "MB", size / 1e6, shift.doors))
    entries.append(limit("cell: disk a door", shift.disk / 1e6, "MB", DISK, shift.doors))
    return entries


def main() -> int:
    """Run alone; 1 when a figure is above what is allowed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--doors", type=int, default=DOORS)
    doors, least = parser.parse_args().doors, len(shipped_recipes())
    if doors < least:
        parser.error(f"--doors is {doors}, allowed are {least} and more: one of every shipped door at least")
    entries = run(doors)
    for item in entries:
        over = ", ABOVE THE LIMIT" if exceeded(item) else ""
        print(
            f"{item.name}: {item.median:.4g} {item.unit}, {item.peer} {item.peer_median:.4g} (n={item.n}){over}"
        )
    return int(any(exceeded(item) for item in entries))


if __name__ == "__main__":
    sys.exit(main())
