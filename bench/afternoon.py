"""An afternoon in a cell: `python bench/afternoon.py --doors 500 --seed 1`.

The shipped executables as processes over one graph, the controller behind its web services and a wire that is cut,
door after door of three ids, each at another place, and with nine doors of ten a fault: a node killed or stopped, the
wire cut, the camera pulled, the folder of target files gone, the recorder's disk full, the clock set by an hour, the
clamp opened, a second goal. What died is started again as launch would. An oracle at the controller's folder keeps
the bytes that stood under a high ready signal when the robot began to mill. Exit code 1 when a row that is wanted to
be 0 is not.
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

from support.afternoon.campaign import Tally, play
from support.afternoon.cell import CREDENTIALS
from support.afternoon.faults import KINDS, draw


def table(tally: Tally, title: str) -> Table:
    """What came of the doors, and what is wanted to be 0."""
    rows = {
        "doors": tally.doors,
        "milled": tally.milled,
        "refused, by code": dict(sorted(tally.refused.items())),
        "starts that the oracle saw": tally.seen,
        "different places of the doors": tally.places,
        **{f"milled with {kind}": f"{tally.milled_by_fault[kind]} of {tally.faults[kind]}" for kind in KINDS},
    }
    wanted = {
        "milled by another door's, run's or place's file": tally.wrong,
        "milled by a file that the oracle did not see": tally.missed,
        "goals without a result": tally.without_result,
        "refusals that nobody foresaw": tally.unforeseen,
        "told as milled, and no robot ended": tally.not_seen,
        "runs that the page's history lacks": tally.not_on_page,
        "files and signals that outlived the last run": tally.left,
        "restarts by hand": tally.manual,
        "nodes that died unstruck": tally.died,
    }
    out = Table(title=title)
    out.add_column("what")
    out.add_column("count", justify="right")
    for what, value in rows.items():
        out.add_row(what, str(value))
    out.add_section()
    for what, found in wanted.items():
        out.add_row(f"{what} (wanted: 0)", str(len(found)), style="bold")
    return out


def main() -> int:
    """Play the afternoon and print its table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--doors", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, metavar="DIR", help="leave logs and folders here")
    arguments = parser.parse_args()
    console, progress, begun = Console(width=150), Console(width=150, stderr=True), time.monotonic()
    os.environ.update(CREDENTIALS)
    with tempfile.TemporaryDirectory(prefix="afternoon-", ignore_cleanup_errors=True) as name:
        os.environ["XDG_DATA_HOME"], os.environ["ROS_LOG_DIR"] = f"{name}/data", f"{name}/ros"
        faults = [draw(arguments.seed, index) for index in range(arguments.doors)]
        folder = (
            arguments.keep or Path(name) / "cell"
        ).resolve()  # nodes take what is relative from their own
        tally = play(folder, faults, lambda line: progress.print(line, highlight=False))
    minutes = (time.monotonic() - begun) / 60.0
    console.print(
        table(tally, f"An afternoon of {tally.doors} doors, seed {arguments.seed}, {minutes:.1f} min")
    )
    troubles = [*tally.troubles(), *tally.missed]
    for line in troubles:
        console.print(line, highlight=False)
    return 1 if troubles else 0


if __name__ == "__main__":
    sys.exit(main())
