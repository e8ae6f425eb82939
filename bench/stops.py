"""The campaign of stops: `python bench/stops.py --runs 200 --seed 1`.

Stops, emergency stops, open guards, losses of power, spindle and clamp while a door is milled by the modules in
rapid/, and doors that are exchanged while the robot stands. Exit code 1 when a standing tool was fed into wood or drawn
through wood beside its own path, a spindle turned or a robot moved behind an open guard, a door was cut by the file of
another, or the next door was not milled right.
"""

from __future__ import annotations

import argparse
import logging
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

from rich.console import Console
from rich.table import Table

from support.stops_campaign import KINDS, Incident, Run, draw
from support.stops_judge import Verdict

FLAGS = ("feeds", "strayed", "turning", "moving", "mistaken")


def table(results: list[tuple[Incident, Verdict]]) -> Table:
    """One row a kind of incident."""
    out = Table(title="Campaign of stops")
    for column in (
        "incident",
        "runs",
        "struck",
        "feeds",
        "strayed",
        "turning",
        "moving",
        "mistaken",
        "false done",
        "next door right",
    ):
        out.add_column(column, justify="left" if column == "incident" else "right")
    for kind in (*KINDS, "all"):
        verdicts = [v for i, v in results if kind in (i.kind, "all")]
        if not verdicts:
            continue
        counts = (
            len(verdicts),
            sum(v.struck for v in verdicts),
            sum(bool(v.feeds) for v in verdicts),
            sum(bool(v.strayed) for v in verdicts),
            sum(bool(v.turning) for v in verdicts),
            sum(bool(v.moving) for v in verdicts),
            sum(bool(v.mistaken) for v in verdicts),
            sum(v.done_unmilled for v in verdicts),
        )
        recovered = f"{sum(v.recovered for v in verdicts)}/{len(verdicts)}"
        out.add_row(kind, *map(str, counts), recovered)
    return out


def play(seed: int) -> tuple[Incident, Verdict]:
    """The run of a seed."""
    incident = draw(seed)
    return incident, Run(incident).mill()


def _quiet() -> None:
    logging.disable(logging.WARNING)


def main() -> int:
    """Run and print."""
    parser = argparse.ArgumentParser(description="Stops of the milling robot, seeded.")
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    console = Console(width=140)
    begin = time.monotonic()
    results = []
    seeds = range(arguments.seed, arguments.seed + arguments.runs)
    with ProcessPoolExecutor(arguments.workers, initializer=_quiet) as pool:
        for incident, verdict in pool.map(play, seeds):
            results.append((incident, verdict))
            flags = [name for name in FLAGS if getattr(verdict, name)]
            flags += [] if verdict.recovered else ["not recovered"]
            found = "right" if verdict.passed else f"{', '.join(flags)}; {verdict.remarks[-1]}"
            console.print(
                f"{incident.seed}: {incident.kind} at {incident.delay:.2f} s: {found}", markup=False
            )
    console.print(table(results))
    bad = sum(not verdict.passed for _, verdict in results)
    minutes = (time.monotonic() - begin) / 60.0
    console.print(f"{len(results)} runs in {minutes:.1f} min, {bad} of them bad")
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
