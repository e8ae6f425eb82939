"""The campaign of nodes that die: `python bench/deaths.py --strikes 100 --seed 1`.

The shipped executables as processes, killed, stopped and continued at drawn moments of every stage and started again
as launch would; two doors alternate. An oracle at the controller's folder keeps the bytes that stood under a high
ready signal when the robot began to mill. Exit code 1 when a door was milled by another one's file, when a goal had
no result, or when the cell did not mill again by itself.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

from rich.console import Console
from rich.table import Table

from support.deaths.campaign import draw, play


def main() -> int:
    """Play the campaign and print its table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--strikes", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    console, begun = Console(width=150), time.monotonic()
    with tempfile.TemporaryDirectory(prefix="deaths-", ignore_cleanup_errors=True) as name:
        os.environ["XDG_DATA_HOME"], os.environ["ROS_LOG_DIR"] = f"{name}/data", f"{name}/ros"
        strikes = [draw(arguments.seed, index) for index in range(arguments.strikes)]
        tally = play(Path(name) / "cell", strikes, console.print)
    table = Table(title=f"Nodes that die, seed {arguments.seed}, {(time.monotonic() - begun) / 60.0:.1f} min")
    rows = {
        "strikes": tally.strikes,
        "goals": tally.goals,
        "milled": tally.milled,
        "refused, by code": dict(sorted(tally.refused.items())),
        "starts that the oracle saw": tally.seen,
        "different places of the doors": tally.places,
        "milled by another door's or place's file": len(tally.wrong),
        "goals without a result": len(tally.without_result),
        "restarts by hand": len(tally.manual),
        "nodes that died unstruck": len(tally.died),
    }
    table.add_column("what")
    table.add_column("count", justify="right")
    for what, value in rows.items():
        table.add_row(what, str(value))
    console.print(table)
    for line in (*tally.wrong, *tally.without_result, *tally.manual):
        console.print(line)
    return 1 if tally.wrong or tally.without_result or tally.manual or tally.died else 0


if __name__ == "__main__":
    sys.exit(main())
