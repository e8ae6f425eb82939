"""What the bags of the last runs come to, in a sentence and as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from doormill_ros.diagnosis.runs.limits import FEWEST
from doormill_ros.monitor.cell_change import DRIFT, CellChange, changes_in

FEW = "few"  #: the verdict of fewer runs than tell a change
_REPAIR = "once that is put right, name the first run after it in since of /model_monitor"


@dataclass(frozen=True)
class RunsFinding:
    """What the runs say.

    Attributes:
        verdict: consistent, explained, partly_explained, unexplained or FEW.
        sentence: The same in words.
        questioned: How many runs that rests on.
        changes: What changed, in the order of the runs.
        runs: Ids of the runs that were asked, oldest first; empty of FEW.
        left_aside: Bags of which not all was asked, and why.
        remarks: Whatever else the runs tell.
        next_measurement: What to measure next; empty where nothing changed.
    """

    verdict: str
    sentence: str
    questioned: int
    changes: tuple[CellChange, ...] = ()
    runs: tuple[str, ...] = ()
    left_aside: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    next_measurement: str = ""


def runs_finding(document: Mapping[str, Any]) -> RunsFinding:
    """Read diagnosis.json of bags.

    Raises:
        KeyError, TypeError, ValueError: It is no such document.
    """
    changes, verdict = changes_in(document), str(document["verdict"])
    runs = tuple(str(run["run_id"]) for run in document["runs"])
    left = tuple(f"{one['bag']}: {one['why']}" for one in document["left_aside"])
    return RunsFinding(
        verdict,
        _sentence(verdict, len(runs), changes, len(left)),
        len(runs),
        changes,
        runs,
        left,
        tuple(str(remark) for remark in document["remarks"]),
        _next(changes),
    )


def few_runs(count: int) -> RunsFinding:
    """Of runs that are too few to tell anything."""
    return RunsFinding(FEW, f"{_runs(count)} by bags alone: changes are told from {FEWEST} on", count)


def _runs(count: int) -> str:
    return "1 run" if count == 1 else f"{count} runs"


def _sentence(verdict: str, count: int, changes: tuple[CellChange, ...], left: int) -> str:
    said = f"{_runs(count)} by bags alone"
    if changes:
        named = " and ".join(change.words for change in changes)
        more = "" if verdict == "explained" else ", and something without a name"
        said = f"{said}: {named}{more}; {_REPAIR}"
    elif verdict == "consistent":
        said = f"{said}: nothing changed"
    else:
        said = f"{said}: something differs, and no known change explains it"
    return f"{said}; bags left aside: {left}" if left else said


def _next(changes: tuple[CellChange, ...]) -> str:
    if not changes:
        return ""
    if all(change.course == DRIFT for change in changes):
        return "gauge one of the first of these doors and one of the last"
    run = next(change.from_run for change in changes if change.course != DRIFT)
    return f"gauge one door from before run {run} and one from after it"
