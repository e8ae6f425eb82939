"""What the command says of a drawn series of runs, beside what was hidden in it."""

from __future__ import annotations

import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from doormill_ros.tools.diagnose import main
from support.run_series import PLACES, Change, Series, draw_series
from support.run_series_bags import write_series

COUNTS = (8, 10, 12, 14, 16, 20, 24, 40)  #: runs of a drawn series


@dataclass(frozen=True)
class RunAnswer:
    """A drawn series and what the command wrote of it."""

    seed: int
    series: Series
    document: dict[str, Any]

    @property
    def causes(self) -> list[dict[str, Any]]:
        """As diagnosis.json has them."""
        return self.document["causes"]

    @property
    def wrong(self) -> list[str]:
        """Names that nothing hidden has, in words."""
        return [
            f"seed {self.seed}: {cause['cause']} at {cause['where']}, hidden were {self.series.changes}"
            for cause in self.causes
            if not any(names(cause, change, self.series) for change in self.series.changes)
        ]

    @property
    def missed(self) -> list[Change]:
        """Hidden changes that nothing names."""
        return [
            change
            for change in self.series.changes
            if not any(names(cause, change, self.series) for cause in self.causes)
        ]

    def begins(self, entry: dict[str, Any], change: Change) -> bool:
        """Whether a step that was found begins with a hidden one."""
        runs = [self.series.run_id(run) for run in range(len(self.series.recipes))]
        low, high = entry["from_run_ci95"]
        near = abs(runs.index(entry["from_run"]) - change.first) <= 1
        return near or low <= runs[change.first] <= high

    @property
    def is_quiet(self) -> bool:
        """Whether nothing is said to be wrong or changed."""
        return self.document["verdict"] == "consistent" and not self.causes and not self.document["changes"]

    def steps(self) -> list[dict[str, Any]]:
        """Changes that are called steps."""
        return [entry for entry in self.document["changes"] if entry["kind"] == "step"]


def names(cause: dict[str, Any], change: Change, series: Series) -> bool:
    """Whether a cause is a hidden change, or one that nothing tells from it and that says so."""
    rivals, beside = series.rivals(change), json.dumps(cause.get("confusable_with", []))
    if cause["where"] != PLACES.get(cause["cause"]):
        return False
    if cause["cause"] == change.kind:
        return series.probe is not None or all(rival in beside for rival in rivals)
    return cause["cause"] in rivals and change.kind in beside


def answer_of(series: Series, folder: Path, seed: int = 0) -> RunAnswer:
    """Write a series below a folder and question it."""
    write_series(series, folder / "runs")
    assert main(["--runs", str(folder / "runs"), "--out", str(folder / "out"), "--quiet"]) == 0
    document = json.loads((folder / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    shutil.rmtree(folder / "runs")
    return RunAnswer(seed, series, document)


def drawn_series(seed: int, spindle: bool = False) -> Series:
    """The series of a seed, of one of a few lengths; `spindle` as for `draw_series`."""
    return draw_series(seed, count=COUNTS[seed % len(COUNTS)], spindle=spindle)


def drawn_answer(seed: int, folder: Path, spindle: bool = False) -> RunAnswer:
    """What is said of that series."""
    return answer_of(drawn_series(seed, spindle), folder, seed)
