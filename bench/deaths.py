"""The campaign of nodes that die: `python bench/deaths.py --strikes 100 --seed 1`.

The shipped executables as processes, killed, stopped and continued at drawn moments of every pair of stages and started
again as launch would; two doors alternate. An oracle at the controller's folder keeps the bytes that stood under a high
ready signal when the robot began to mill. Exit code 1 when a door was milled by another one's file or by one that the
oracle did not see, when a target file outlived its run, when a goal had no result, when a dead node was named late, or
when the cell did not mill again by itself.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

from rich.console import Console
from rich.table import Table

from support.deaths.campaign import NAMED, play
from support.deaths.strikes import deal

KEPT = Path("out/deaths")  # logs of rounds that took long


def main() -> int:
    """Play the campaign and print its table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--strikes", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    console, begun = Console(width=150), time.monotonic()
    with tempfile.TemporaryDirectory(prefix="deaths-", ignore_cleanup_errors=True) as name:
        os.environ["XDG_DATA_HOME"], os.environ["ROS_LOG_DIR"] = f"{name}/data", f"{name}/ros"
        rounds = deal(arguments.seed, arguments.strikes // 2)
        tally = play(Path(name) / "cell", rounds, console.print, KEPT)
    table = Table(title=f"Nodes that die, seed {arguments.seed}, {(time.monotonic() - begun) / 60.0:.1f} min")
    rows = {
        "strikes": tally.strikes,
        "node, kill -9 or stop, and stage: different ones": len(tally.struck),
        "pairs of stages": len({tuple(strike.stage for strike in strikes) for strikes in rounds}),
        "of which both strikes fell in one run": len(tally.together),
        "goals": tally.goals,
        "milled": tally.milled,
        "refused, by code": dict(sorted(tally.refused.items())),
        "starts that the oracle saw": tally.seen,
        "starts that it missed, kept from looking": tally.missed,
        "different places of the doors": tally.places,
        "refusals that name the node that was struck": len(tally.named),
        "strike to the refusal that names a dead node, longest [s]": round(max(tally.named, default=0.0), 1),
        "first strike to the next milled door, median [s]": round(median(tally.again), 1),
        "first strike to the next milled door, longest [s]": round(max(tally.again), 1),
        "milled by another door's or place's file": len(tally.wrong),
        "told as milled, and no robot ended": len(tally.not_ended),
        "target files that outlived their run": len(tally.left),
        "goals without a result": len(tally.without_result),
        "restarts by hand": len(tally.manual),
        "nodes that ended so as to be heard again": len(tally.renewed),
        "nodes that died unstruck": len(tally.died),
    }
    table.add_column("what")
    table.add_column("count", justify="right")
    for what, value in rows.items():
        table.add_row(what, str(value))
    console.print(table)
    failures = [
        *tally.wrong,
        *tally.not_ended,
        *tally.left,
        *tally.without_result,
        *tally.manual,
        *tally.died,
    ]
    if tally.missed:
        failures.append(f"{tally.missed} milled doors of which nobody knows by what file")
    failures += [
        f"a dead node was named later than {NAMED:g} s after the strike: {late}" for late in tally.late
    ]
    for line in failures:
        console.print(line)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
