"""A shift of doors over Robot Web Services 1.0: `python bench/shift.py --doors 100`.

One continuous run of the modules in rapid/, the real client and the simulated controller's server, two doors in turn.
Exit code 1 when a door was not milled right, was asked for twice or was not reported as done, or when handles, threads
or memory grow from door to door.
"""

from __future__ import annotations

import argparse
import logging
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

from rich.console import Console

from support.shift import DoorReport, Shift

KINDS = ("thesis_190_0deg", "thesis_1350_0deg")
#: Doors after which the process holds what it needs.
WARM = 10
#: Largest growth of memory a door [MB]: what one door's path takes would show.
GROWTH = 0.2


def main() -> int:
    """Mill and judge."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--doors", type=int, default=100)
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    console, begin = Console(width=140), time.monotonic()

    def show(number: int, report: DoorReport, fault: str) -> None:
        console.print(f"{number}: {report.door}, {fault or 'right'}; {report.held}", markup=False)

    with tempfile.TemporaryDirectory(prefix="shift-") as folder:
        shift = Shift(Path(folder), KINDS, arguments.doors)
        faults = shift.run(show)
    held = [report.held for report in shift.reports if report.held is not None]
    if len(held) > WARM + 1:
        first, last, doors = held[WARM], held[-1], len(held) - WARM - 1
        growth = (last.memory - first.memory) / doors
        console.print(
            f"from door {WARM} on: {growth:.3f} MB a door, handles {first.handles} to {last.handles}, "
            f"threads {first.threads} to {last.threads}"
        )
        faults += (
            [f"memory grows by {growth:.3f} MB a door, allowed is {GROWTH:g}"] if growth > GROWTH else []
        )
        faults += (
            ["handles or threads grow"]
            if last.handles > first.handles or last.threads > first.threads
            else []
        )
    for fault in faults:
        console.print(fault, markup=False)
    minutes = (time.monotonic() - begin) / 60.0
    console.print(f"{len(held)} of {arguments.doors} doors in {minutes:.1f} min, {len(faults)} faults")
    return int(bool(faults) or len(held) < arguments.doors)


if __name__ == "__main__":
    sys.exit(main())
