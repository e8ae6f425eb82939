"""The bags of a series of runs question whether the cell is still as it was when the series began."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.changes import change_sentences, changes_document, changes_of, diagnosed_at
from doormill_ros.diagnosis.core.kind import Progress, SearchedKind
from doormill_ros.diagnosis.core.telling.account import Account, account_of
from doormill_ros.diagnosis.core.words.wording import Words
from doormill_ros.diagnosis.runs.channels import Channel, channels_of
from doormill_ros.diagnosis.runs.latest_runs import LeftBag, latest_runs
from doormill_ros.diagnosis.runs.limits import FEWEST, MOST, fewest
from doormill_ros.diagnosis.runs.problem import RunChange, RunDiagnosis, RunProblem
from doormill_ros.diagnosis.runs.steps import possible_steps
from doormill_ros.diagnosis.runs.ungauged_run import UngaugedRun, ungauged_runs
from doormill_ros.pages.charts import BLUE, DARK, Curve, scatter
from doormill_ros.pages.page import Charts, PageSection
from doormill_ros.recording.errors import UnreadableBagError
from doormill_ros.units import m_to_um

METHOD = """Every figure of a run is compared with the same figure of the other runs: where the camera and other sensors
find the door, how far edges lie from straight lines, how repeated pictures scatter, how long controller and link take,
and how much the spindle works. Its level, what goes with the door's width or the predicted time, the recipe and where
each door stood are taken out; how far it scatters is seen between neighbouring runs. Every change was fitted alone and
in combination, and scored on whole runs left out of its fit."""


@dataclass(frozen=True, eq=False)
class RunSeries:
    """The runs of a folder.

    Attributes:
        path: The folder.
        runs: In their order; the last ones where there were too many.
        left: How many were left out before these.
        left_aside: Bags of which not all was asked.
    """

    path: Path
    runs: Sequence[UngaugedRun]
    left: int = 0
    left_aside: Sequence[LeftBag] = ()


class Runs(SearchedKind[RunSeries, RunProblem, RunChange]):
    """Recorded runs without an inspection.

    Args:
        last: How many runs are asked, the last ones; then bags that cannot be read are left aside. None: all, and
            every bag has to be read.
        since: The first run that counts; empty: all do.
    """

    words = Words("cell as it was at first", "figures", "difference", "difference", "runs", METHOD)
    next_measurement = (
        "gauge a door milled before the change and one after it, and question them with --inspections"
    )

    def __init__(self, last: int | None = None, since: str = "") -> None:
        self._last, self._since = last, since

    def read(self, folder: Path, progress: Progress) -> Sequence[RunSeries]:
        """All runs below a folder as one series.

        Raises:
            BagError: A bag cannot be read, or there is none.
        """
        progress(f"reading the bags in {folder}")
        left_aside: Sequence[LeftBag] = ()
        if self._last is None:
            runs = [run for run in ungauged_runs(folder) if run.run_id >= self._since]
        else:
            latest = latest_runs(folder, self._last, self._since)
            runs, left_aside = list(latest.runs), latest.left
        if len(runs) < 2 or not channels_of(runs, fewest(len(runs))):
            raise UnreadableBagError(
                f"the bags in {folder} hold {len(runs)} runs{self._counted}, allowed are 2 or more that tell the "
                "same: a pose, a reading or a time; give a folder with bags of more runs",
                folder=str(folder),
            )
        return [RunSeries(folder, runs[-MOST:], max(len(runs) - MOST, 0), left_aside)]

    @property
    def _counted(self) -> str:
        return f" from {self._since!r} on" if self._since else ""

    def problem(self, sets: Sequence[RunSeries]) -> RunProblem:
        """The figures of all runs."""
        return RunProblem([run for one in sets for run in one.runs])

    def diagnose(self, sets: Sequence[RunSeries], progress: Progress) -> RunDiagnosis:
        """Look for runs at which something changed, then search, examine and weigh."""
        problem = self.problem(sets)
        return diagnosed_at(problem, possible_steps(problem), progress)

    def name(self, one: RunSeries) -> str:
        """Its folder."""
        return one.path.name

    def account(
        self,
        diagnosis: RunDiagnosis,
        sets: Sequence[RunSeries],
        checks: Sequence[Mapping[str, Any]],
        progress: Progress,
    ) -> Account:
        """With what changed since which run, and a chart of every figure."""
        progress("asking since when")
        changes = changes_of(diagnosis)
        remarks = [*change_sentences(diagnosis, changes), *_scope(diagnosis.problem, sets)]
        account = account_of(diagnosis, self.words, self.next_measurement, checks)
        runs = diagnosis.problem.doors
        return replace(
            account,
            sections={
                "runs": [{"run_id": run.run_id, "recipe": run.recipe, "time": run.time} for run in runs],
                "told_by": [channel.name for channel in diagnosis.problem.channels],
                "changes": changes_document(diagnosis, changes),
                "left_aside": [
                    {"bag": str(left.bag), "why": left.why} for one in sets for left in one.left_aside
                ],
            },
            remarks=[*remarks, *account.remarks],
            closing=[
                PageSection("Run by run", [Charts([_chart(c) for c in diagnosis.problem.channels], "halves")])
            ],
        )


def _scope(problem: RunProblem, sets: Sequence[RunSeries]) -> list[str]:
    found = []
    if len(problem.doors) < FEWEST:
        found.append(f"{len(problem.doors)} runs tell no change; {FEWEST} or more do.")
    far: dict[str, list[str]] = {}
    for run, name in problem.strays:
        far.setdefault(problem.doors[run].name, []).append(name)
    if far:
        told = "; ".join(f"{run}: {', '.join(names)}" for run, names in far.items())
        found.append(f"Single runs are far from those around them and count nowhere: {told}.")
    left = sum(one.left for one in sets)
    if left:
        found.append(f"{left} older runs were left out: {MOST} are questioned at once.")
    found += [f"Left aside: {bag.words}." for one in sets for bag in one.left_aside]
    return found


def _chart(channel: Channel) -> Any:
    number, told = np.arange(1.0, len(channel.values) + 1.0), np.isfinite(channel.values)
    values = channel.values[told]
    shown, unit = (
        (m_to_um(values - np.median(values)), {"m": "um", "rad": "urad"}[channel.unit])
        if channel.axis >= 0
        else (np.exp(values - np.median(values)), "times the median")
    )
    dots = Curve("", BLUE, number[told], shown)
    return scatter(
        channel.name, "run", unit, [dots], [Curve("", DARK, number[[0, -1]], np.full(2, np.median(shown)))]
    )
