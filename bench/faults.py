"""The fault campaign: `python bench/faults.py --runs 300 --seed 1`.

Real processes are killed at every state, files torn, disks filled, connections dropped, slowed and
held back, requests doubled. A robot mills what it is given; the judge knows what it should have been.
Exit code 1 when a wrong or incomplete file was milled, or when a run did not recover.
"""

from __future__ import annotations

import argparse
import logging
import sys
import time
from collections import defaultdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

from rich.console import Console
from rich.table import Table

from support.faults.judge import Verdict
from support.faults.run import campaign
from support.faults.scenario import KINDS, Scenario, draw


def table(results: list[tuple[Scenario, Verdict]]) -> Table:
    """One row a kind of fault."""
    rows: dict[str, list[Verdict]] = defaultdict(list)
    for scenario, verdict in results:
        rows[scenario.kind].append(verdict)
    out = Table(
        title="Fault campaign", caption="offered: a file that was not right under a high ready signal"
    )
    columns = (
        "fault",
        "runs",
        "struck",
        "requests",
        "milled",
        "refused",
        "offered wrong",
        "milled wrong",
        "recovered",
    )
    for column in columns:
        out.add_column(column, justify="left" if column == "fault" else "right")
    for kind in (*(k for k in KINDS if k in rows), "all"):
        verdicts = rows[kind] if kind != "all" else [v for _, v in results]
        out.add_row(
            kind,
            str(len(verdicts)),
            str(sum(v.faults for v in verdicts)),
            str(sum(v.requests for v in verdicts)),
            str(sum(v.milled for v in verdicts)),
            str(sum(v.refused.total() for v in verdicts)),
            str(sum(v.wrong_offered for v in verdicts)),
            str(sum(len(v.wrong) for v in verdicts)),
            f"{sum(v.recovered for v in verdicts)}/{len(verdicts)}",
            style="bold" if kind == "all" else None,
        )
    return out


def main() -> int:
    """Play the campaign and print its table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=4)
    parser.add_argument("--kind", default="", help="only kinds of faults whose name contains this")
    parser.add_argument(
        "--robot", default="", choices=["", "checks", "blind"], help="instead of the drawn one"
    )
    parser.add_argument("--sabotage", default="", choices=["", "verify", "clear"], help="leave this out")
    arguments = parser.parse_args()
    logging.disable(logging.CRITICAL)
    scenarios, index = [], 0
    while len(scenarios) < arguments.runs:
        scenario = draw(arguments.seed, index)
        index += 1
        if arguments.kind not in scenario.kind:
            continue
        changes = {"sabotage": arguments.sabotage} | ({"robot": arguments.robot} if arguments.robot else {})
        scenarios.append(Scenario(**{**scenario.__dict__, **changes}))
    begin = time.monotonic()
    results = campaign(scenarios, arguments.workers)
    console = Console(width=130)
    console.print(table(results))
    wrong = [(s, text) for s, v in results for text in v.wrong]
    stuck = [s for s, v in results if not v.recovered]
    for scenario, text in wrong:
        console.print(f"[red]milled wrong[/red] {scenario.kind} (run seed {scenario.seed}): {text}")
    for scenario in stuck:
        console.print(f"[yellow]not recovered[/yellow] {scenario.kind} (run seed {scenario.seed})")
    minutes = (time.monotonic() - begin) / 60.0
    console.print(
        f"{len(results)} runs in {minutes:.1f} min: {len(wrong)} wrong or incomplete files milled, "
        f"{len(stuck)} runs not recovered"
    )
    return 1 if wrong or stuck else 0


if __name__ == "__main__":
    sys.exit(main())
