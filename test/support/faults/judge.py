"""Decides from the logs of a run what the robot milled, and whether it was what it should have milled."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from support.faults.world import World


@dataclass
class Verdict:
    """Counts of one run.

    Attributes:
        requests: Doors the robot asked a path for.
        milled: Files it milled.
        refused: Files its own check refused, by reason.
        wrong_offered: Files under a high ready signal that were not the right one, all of them refused.
        wrong: What it milled wrongly, in words; must be empty.
        faults: Faults that really happened.
        recovered: It milled a door after the last fault.
        submissions_refused: Submissions the handshake turned down.
    """

    requests: int = 0
    milled: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    wrong_offered: int = 0
    wrong: list[str] = field(default_factory=list)
    faults: int = 0
    recovered: bool = False
    submissions_refused: Counter[str] = field(default_factory=Counter)


def judge(world: World) -> Verdict:
    """Read the logs of a run."""
    verdict = Verdict()
    planned = {entry["sha"]: entry for entry in world.entries("planned")}
    milled_runs: set[str] = set()
    for entry in world.entries("robot"):
        event = entry["event"]
        if event == "request":
            verdict.requests += 1
        elif event == "refused":
            verdict.refused[entry["reason"]] += 1
        elif event == "offered":
            verdict.wrong_offered += bool(fault_of(entry, planned))
        elif event == "milled":
            verdict.milled += 1
            fault = fault_of(entry, planned)
            if not fault and entry["run"] in milled_runs:
                fault = "milled twice"
            if not fault and entry["run"] not in (planned[entry["sha"]]["run"], entry["sha"]):
                fault = "of another run"
            if fault:
                verdict.wrong.append(f"placement {entry['placement']}, run {entry['run']}: {fault}")
            milled_runs.add(entry["run"])
    verdict.faults = len(world.entries("faults"))
    verdict.submissions_refused.update(e["refused"] for e in world.entries("submissions"))
    return verdict


def fault_of(entry: dict, planned: dict[str, dict]) -> str:
    """Why the file of a robot's log entry is wrong, "" when it is right."""
    plan = planned.get(entry["sha"])
    if plan is None:
        return "no complete file that anybody planned"
    if plan["placement"] != entry["placement"]:
        return f"made for placement {plan['placement']}"
    if plan["door"] != entry["door"]:
        return f"made for door {plan['door']}"
    return ""
