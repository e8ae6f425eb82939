"""Runs that tell less than usual: of no time, of one figure, of no prediction, or half of them of nothing."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.diagnosis.runs import kind as kind_of_runs
from doormill_ros.diagnosis.runs.kind import Runs, RunSeries
from doormill_ros.diagnosis.runs.problem import RunProblem
from doormill_ros.diagnosis.runs.ungauged_run import FoundDoor, UngaugedRun
from doormill_ros.errors import DoormillError

QUIET = lambda line: None  # noqa: E731
COUNT = 12
STEP = 8


def series(seed=3, step=0.0):
    """Runs with a picture and times each; from one on doors are found elsewhere."""
    rng = np.random.default_rng(seed)
    return [
        UngaugedRun(
            name=f"r{number}",
            run_id=f"r{number}",
            recipe="oak",
            width=0.9,
            time=1e9 + 100.0 * number,
            pictures=(
                FoundDoor(
                    rng.normal(0.0, 1e-5, 3) + step * (number >= STEP) * np.array([1.0, 0.0, 0.0]),
                    np.full(3, 1e-5),
                ),
            ),
            cycle_time=70.0,
            milling=70.0 * float(np.exp(rng.normal(0.0, 1e-3))),
            answer=0.1 * float(np.exp(rng.normal(0.0, 0.1))),
            link=0.1 * float(np.exp(rng.normal(0.0, 0.1))),
        )
        for number in range(COUNT)
    ]


def asked(runs):
    return Runs().diagnose([RunSeries(Path("runs"), runs)], QUIET)


def sections(runs, diagnosis):
    return Runs().account(diagnosis, [RunSeries(Path("runs"), runs)], [], QUIET)


POOR = {
    "as usual": lambda run: run,
    "without a time": lambda run: replace(run, time=0.0),
    "under one stamp": lambda run: replace(run, time=5.0),
    "without a prediction": lambda run: replace(run, cycle_time=0.0),
}


@pytest.mark.parametrize("poor", POOR.values(), ids=POOR)
def test_a_clear_step_is_told_whatever_is_missing(poor):
    runs = [poor(run) for run in series(step=5e-4)]
    diagnosis = asked(runs)
    assert {finding.cause.name for finding in diagnosis.findings} <= {"camera_shift", "clamp_shift"}
    assert len(diagnosis.findings) == 1
    account = sections(runs, diagnosis)
    assert [change["from_run"] for change in account.sections["changes"]] == [f"r{STEP}"]


def test_runs_of_equal_figures_are_consistent():
    same = series()[0]
    runs = [replace(same, name=f"r{k}", run_id=f"r{k}", time=same.time + 100.0 * k) for k in range(COUNT)]
    diagnosis = asked(runs)
    assert (diagnosis.verdict, list(diagnosis.findings)) == ("consistent", [])
    assert sections(runs, diagnosis).remarks is not None


@pytest.mark.parametrize(("telling", "refused"), [(5, True), (6, False)])
def test_figures_that_few_runs_tell_are_asked_where_they_are_read_and_nowhere_else(
    telling, refused, monkeypatch
):
    nothing = {"pictures": (), "cycle_time": np.nan, "milling": np.nan, "answer": np.nan, "link": np.nan}
    runs = [run if number < telling else replace(run, **nothing) for number, run in enumerate(series())]
    monkeypatch.setattr(kind_of_runs, "ungauged_runs", lambda folder: runs)
    if refused:
        with pytest.raises(DoormillError, match="allowed are 2 or more"):
            Runs().read(Path("runs"), QUIET)
        return
    (read,) = Runs().read(Path("runs"), QUIET)
    assert len(RunProblem(read.runs)) > 0
    assert asked(read.runs).verdict == "consistent"
