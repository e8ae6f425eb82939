"""Decides from the logs of a run what the robot milled, and whether it was what it should have milled."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from support.faults.world import TARGETS, World, positions

#: Half the distance between two placements' paths [mm].
_CLOSE = 0.4


@dataclass
class Verdict:
    """Counts of one run.

    Attributes:
        requests: Doors the robot asked a path for.
        milled: Doors it milled.
        refused: Files its own check refused, and doors that it gave up, by reason.
        wrong_offered: Files under a high ready signal of a blind robot that were not the right one.
        wrong: What it milled wrongly, in words; must be empty.
        failed: Doors that were milled well and that the PC reported as failed; must be empty.
        faults: Faults that really happened.
        recovered: It milled a door after the last fault.
        submissions_refused: Submissions the handshake turned down.
    """

    requests: int = 0
    milled: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    wrong_offered: int = 0
    wrong: list[str] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)
    faults: int = 0
    recovered: bool = False
    submissions_refused: Counter[str] = field(default_factory=Counter)


def judge(world: World) -> Verdict:
    """Read the logs of a run."""
    verdict = Verdict()
    planned = {entry["sha"]: entry for entry in world.entries("planned")}
    seen: set[str] = set()
    good: set[int] = set()
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
            good.add(entry["placement"])
            if "sha" in entry:
                fault = fault_of(entry, planned) or ("milled twice" if entry["run"] in seen else "")
                seen.add(entry["run"])
                if fault:
                    verdict.wrong.append(f"placement {entry['placement']}: {fault}")
    verdict.wrong += faults_of_motions(world)
    verdict.failed = reported_as_failed(world, good)
    verdict.faults = len(world.entries("faults"))
    verdict.submissions_refused.update(e["refused"] for e in world.entries("submissions"))
    return verdict


def fault_of(entry: dict, planned: dict[str, dict]) -> str:
    """Why the file of a blind robot's log entry is wrong, "" when it is right."""
    plan = planned.get(entry["sha"])
    if plan is None:
        return "no complete file that anybody planned"
    if plan["placement"] != entry["placement"]:
        return f"made for placement {plan['placement']}"
    if plan["door"] != entry["door"]:
        return f"made for door {plan['door']}"
    return ""


def faults_of_motions(world: World) -> list[str]:
    """What the robot's motions did to the doors that stood in the clamp, where that was wrong."""
    found: dict[str, None] = {}
    at: dict[int, int] = {}  # how far a door's path was followed
    for entry in world.entries("robot"):
        if entry["event"] != "moved":
            continue
        placement, door = entry["placement"], entry["door"]
        if not placement:
            found["milled without a door in the clamp"] = None
            continue
        index = _index(positions(placement, door), entry["y"], entry["z"])
        before = at.get(placement, -1)
        if index is None:
            place = f"y {entry['y']:.1f} mm, z {entry['z']:.1f} mm"
            found[f"placement {placement}: not the path of {door} there, at {place}"] = None
        elif index < before:
            found[f"placement {placement}: milled twice"] = None
        elif index > before + 1:
            found[f"placement {placement}: {index - before - 1} targets left out"] = None
        at[placement] = before if index is None else index
    for entry in world.entries("robot"):
        followed = at.get(entry.get("placement", 0), -1)
        if entry["event"] == "milled" and "sha" not in entry and followed != TARGETS - 1:
            found[f"placement {entry['placement']}: called done after {followed + 1} targets"] = None
    return list(found)


def reported_as_failed(world: World, good: set[int]) -> list[str]:
    """Runs that the PC called failed although the robot had taken them and milled their door to its end.

    Of a run that was taken, the first of done, failed and another request says how it ended; a PC that was killed
    before that has said nothing.
    """
    placements = {entry["run"]: entry["placement"] for entry in world.entries("planned")}
    found, taken, life = [], "", -1
    for entry in world.entries("bridge"):
        if entry["life"] != life:
            taken, life = "", entry["life"]
        if entry["state"] == "milling":
            taken = entry["run"]
        elif entry["state"] in ("done", "failed", "requested"):
            if taken and entry["state"] != "done" and placements.get(taken) in good:
                found.append(
                    f"placement {placements[taken]}, run {taken}: {entry['state']}: {entry['reason']}"
                )
            taken = ""
    return found


def _index(path: list[tuple[float, float]], y: float, z: float) -> int | None:
    for index, (wanted_y, wanted_z) in enumerate(path):
        if abs(y - wanted_y) < _CLOSE and abs(z - wanted_z) < _CLOSE:
            return index
    return None
