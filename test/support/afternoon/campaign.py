"""Plays an afternoon: goal after goal, a fault with nearly each, and what came of them."""

from __future__ import annotations

import json
import random
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from doormill_ros.abb import signals
from doormill_ros.errors import DoormillError
from doormill_ros.operator.history.history import FILE
from support.afternoon.cell import DOORS, AfternoonCell, running
from support.afternoon.faults import Fault
from support.deaths.campaign import RESULT_LIMIT
from support.deaths.leftovers import Leftovers
from support.waiting import LIMIT

SETTLING = 30.0  # s, for what is told of the last run
KEPT_BAGS = 3  # the newest ones; hundreds would fill the disk


@dataclass
class Tally:
    """What came of the doors."""

    doors: int = 0
    milled: int = 0
    refused: Counter[int] = field(default_factory=Counter)
    faults: Counter[str] = field(default_factory=Counter)
    milled_by_fault: Counter[str] = field(default_factory=Counter)
    seen: int = 0  # times the oracle saw the robot begin
    places: int = 0  # different ones where a door stood then
    wrong: list[str] = field(default_factory=list)
    without_result: list[str] = field(default_factory=list)
    unforeseen: list[str] = field(default_factory=list)
    not_seen: list[str] = field(default_factory=list)
    not_on_page: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)
    manual: list[str] = field(default_factory=list)
    died: list[str] = field(default_factory=list)
    #: Begun while the oracle was kept from looking. No trouble of the cell's, so no test asks for it: how soon a
    #: machine lets a thread look is its own affair. A kept run has none, or says nothing of these doors.
    missed: list[str] = field(default_factory=list)

    def troubles(self) -> list[str]:
        """What must not be, a line each."""
        lists = (self.wrong, self.without_result, self.unforeseen, self.not_seen, self.not_on_page, self.left)
        return [line for found in (*lists, self.manual, self.died) for line in found]


class _Afternoon:
    def __init__(self, cell: AfternoonCell, tally: Tally, draw_place: random.Random) -> None:
        self.cell, self.tally, self.draw_place = cell, tally, draw_place
        self.leftovers = Leftovers(cell.folder / "HOME")
        self.turn = 0
        self.successes: list[str] = []
        self.runs: list[str] = []

    def door(self) -> str:
        self.turn += 1
        return DOORS[self.turn % len(DOORS)]

    def goal(self, what: str, meanwhile: Callable[[], None] = lambda: None) -> Any:
        """A goal and what is said of its result."""
        self.cell.client.move(self.draw_place)
        self.leftovers.sent()
        result = self.cell.client.mill(self.door(), RESULT_LIMIT, meanwhile)
        if result is None:
            self.tally.without_result.append(f"no result: {what}")
            return None
        self.leftovers.told(result.run_id)
        if result.run_id:
            self.runs.append(result.run_id)
        if result.success:
            self.successes.append(result.run_id)
        elif result.error_code <= DoormillError.code or not result.message:
            self.tally.unforeseen.append(f"{what}: {result.error_code} {result.message}")
        return result

    def one(self, fault: Fault) -> Any:
        """A door, and its fault."""
        other: list[Any] = []

        def meanwhile() -> None:
            other.append(self.cell.client.second(DOORS[(self.turn + 1) % len(DOORS)], RESULT_LIMIT))

        striking = threading.Thread(target=self.cell.strike, args=(fault, meanwhile))
        result = self.goal(str(fault), striking.start)
        striking.join()
        for second in other:
            if second is None:
                self.tally.without_result.append(f"no result of the other goal: {fault}")
            elif second.success:
                self.successes.append(second.run_id)
        return result

    def until_milled(self) -> bool:
        """Goals until each door was milled again, by nobody's hand."""
        wanted, deadline = set(DOORS), time.monotonic() + LIMIT
        while wanted and time.monotonic() < deadline:
            result = self.goal("a goal without a fault")
            if result is not None and result.success:
                wanted.discard(DOORS[self.turn % len(DOORS)])
            elif wanted:
                time.sleep(0.5)
        return not wanted

    def sum_up(self) -> None:
        """What oracle, page and folder say when the last door is done."""
        tally, cell = self.tally, self.cell
        cell.oracle.close()
        tally.wrong = cell.oracle.faults()
        tally.seen, tally.places = len(cell.oracle.starts), cell.oracle.places()
        begun = b"\n".join(start.data for start in cell.oracle.starts)
        ended = b"\n".join(cell.oracle.named)
        tally.not_seen = [
            f"told as milled, and no robot ended: {run}"
            for run in self.successes
            if run.encode() not in ended
        ]
        tally.missed = [
            f"milled, and nobody saw by what file: {run}"
            for run in self.successes
            if run.encode() not in begun
        ]
        deadline = time.monotonic() + SETTLING
        while (missing := set(self.runs) - _on_page(cell.folder)) and time.monotonic() < deadline:
            time.sleep(0.1)
        tally.not_on_page = [f"not in the page's history: {run}" for run in sorted(missing)]
        tally.left = list(self.leftovers.found)
        home = cell.folder / "HOME"
        if (home / signals.TARGET_FILE).exists():
            tally.left.append("a target file outlived the last run")
        if (home / "io" / signals.READY).read_text().strip() != "0":
            tally.left.append("ready stayed high after the last run")
        tally.died = cell.supervisor.deaths_by_themselves


def _on_page(folder: Path) -> set[str]:
    try:
        lines = (folder / "runs" / FILE).read_text(encoding="utf-8").splitlines()
    except OSError:
        return set()
    return {json.loads(line)["run_id"] for line in lines}


def play(folder: Path, faults: list[Fault], tell: Callable[[str], None] = lambda line: None) -> Tally:
    """Mill a door with each fault, in one cell."""
    tally = Tally()
    with running(folder) as cell:
        afternoon = _Afternoon(cell, tally, random.Random(len(faults)))
        if not afternoon.until_milled():
            tally.manual.append("the cell did not come up")
            return tally
        for number, fault in enumerate(faults):
            begun = time.monotonic()
            result = afternoon.one(fault)
            tally.doors += 1
            tally.faults[fault.kind] += 1
            if result is not None and result.success:
                tally.milled += 1
                tally.milled_by_fault[fault.kind] += 1
            elif result is not None:
                tally.refused[result.error_code] += 1
            came_to = "no result" if result is None else f"{result.error_code} {result.message[:70]}"
            tell(
                f"{number + 1}/{len(faults)} {time.monotonic() - begun:5.1f} s {fault.kind}, {fault.node}, "
                f"{fault.stage}: {came_to}"
            )
            _remove_old_bags(folder / "bags")
        if not afternoon.until_milled():
            tally.manual.append("the cell did not mill each door again by itself")
        afternoon.sum_up()
    return tally


def _remove_old_bags(folder: Path) -> None:
    bags = sorted(path for path in folder.glob("*") if path.is_dir()) if folder.is_dir() else []
    for bag in bags[:-KEPT_BAGS]:
        for path in bag.iterdir():
            path.unlink()
        bag.rmdir()
