"""The fault campaign: `python bench/faults.py --runs 300 --seed 1`.

Real processes are killed at every state, files torn, disks filled, connections dropped, slowed and
held back, requests doubled, controllers started anew. The project's RAPID modules mill what they are
given; the judge looks at the motions alone, beside the door in the clamp. Exit code 1 when a door was
milled wrong, when a good door was called failed, or when a run did not recover.
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
        "good called failed",
        "recovered",
    )
    for column in columns:
        left = column == "fault"
        out.add_column(column, justify="left" if left else "right", no_wrap=left)
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
            str(sum(len(v.failed) for v in verdicts)),
            f"{sum(v.recovered for v in verdicts)}/{len(verdicts)}",
            style="bold" if kind == "all" else None,
        )
    return out


def troubles(verdict: Verdict) -> list[str]:
    """What must not be, in words."""
    wrong = [f"milled wrong: {text}" for text in verdict.wrong]
    failed = [f"good, called failed: {text}" for text in verdict.failed]
    return wrong + failed + ([] if verdict.recovered else ["not recovered"])


def main() -> int:
    """Play the campaign and print its table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=4)
    parser.add_argument("--first", type=int, default=0, help="leave out the runs before this one")
    parser.add_argument("--kind", default="", help="only kinds of faults whose name contains this")
    parser.add_argument("--robot", default="", choices=["", "blind"], help="instead of the RAPID modules")
    parser.add_argument(
        "--sabotage", default="", choices=["", "verify", "clear", "mark"], help="leave this out"
    )
    arguments = parser.parse_args()
    logging.disable(logging.CRITICAL)
    scenarios, numbers, index = [], [], arguments.first
    while len(scenarios) < arguments.runs:
        scenario = draw(arguments.seed, index)
        index += 1
        if arguments.kind not in scenario.kind:
            continue
        changes = {"sabotage": arguments.sabotage} | ({"robot": arguments.robot} if arguments.robot else {})
        numbers.append(index - 1)
        scenarios.append(Scenario(**{**scenario.__dict__, **changes}))
    begin = time.monotonic()
    console = Console(width=150)
    indices = {id(scenario): number for number, scenario in zip(numbers, scenarios, strict=True)}

    def show(scenario: Scenario, verdict: Verdict, seconds: float) -> None:
        found = "; ".join(troubles(verdict)) or "right"
        number, way = indices[id(scenario)], f"{scenario.kind} over {scenario.transport}"
        console.print(f"{number}: {way}, {verdict.milled} milled, {seconds:.0f} s: {found}", markup=False)

    results = campaign(scenarios, arguments.workers, show)
    console.print(table(results))
    wrong = sum(len(verdict.wrong) for _, verdict in results)
    failed = sum(len(verdict.failed) for _, verdict in results)
    stuck = sum(not verdict.recovered for _, verdict in results)
    minutes = (time.monotonic() - begin) / 60.0
    console.print(
        f"{len(results)} runs in {minutes:.1f} min: {wrong} wrong or incomplete files milled, "
        f"{failed} good doors called failed, {stuck} runs not recovered"
    )
    return 1 if wrong or failed or stuck else 0


if __name__ == "__main__":
    sys.exit(main())
