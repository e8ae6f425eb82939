"""Runs a whole diagnosis of measurement sets and writes its files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.diagnosis.loading.diagnosis import Diagnosis, diagnose_set
from doormill_ros.diagnosis.loading.document import (
    diagnosis_document,
    extended_model_document,
    write_diagnosis,
)
from doormill_ros.diagnosis.loading.finding import rmse
from doormill_ros.diagnosis.loading.margins import margins
from doormill_ros.diagnosis.loading.next_measurement import NextMeasurement, plan_next
from doormill_ros.diagnosis.loading.path_shift import doubt, path_shift
from doormill_ros.diagnosis.loading.problem import Problem
from doormill_ros.diagnosis.loading.report import render_report
from doormill_ros.measurements.join_sets import check_same_model, join_sets
from doormill_ros.measurements.measurement_set import MeasurementSet, read_measurement_set


def run_measurement_sets(
    data: Sequence[Path], check: Sequence[Path], out: Path, progress: Callable[[str], None]
) -> str:
    """Diagnose sets together, predict the sets to check, write the results.

    Returns:
        The verdict in one line.

    Raises:
        DataSetError: A set cannot be read or the sets do not belong together; nothing is written.
    """
    sets = [read_measurement_set(folder) for folder in data]
    checks = [read_measurement_set(folder) for folder in check]
    joined = join_sets(sets)
    for other in checks:
        check_same_model(joined, other)
    diagnosis = diagnose_set(joined, progress)
    progress("choosing the next trials")
    plan = plan_next(diagnosis)
    checked = [check_set(diagnosis, other) for other in checks]
    progress("sending the extended model through the path generator")
    shift = path_shift(diagnosis)
    unchanged = doubt(diagnosis)
    progress("writing the report")
    more: dict[str, Any] = {"next_trials": _trials(plan)}
    if shift is not None:
        more["path_shift"] = {"door": shift.door, "largest": shift.largest, "unit": "m"}
    if unchanged:
        diagnosis = replace(diagnosis, remarks=(*diagnosis.remarks, unchanged))
        more["model_unchanged"] = unchanged
    if checked:
        more["checks"] = checked
    more["margins"] = [margin.document() for margin in margins(diagnosis)]
    document = diagnosis_document(diagnosis, plan.sentence, **more)
    page = render_report(diagnosis, plan, checked, shift, more["margins"])
    write_diagnosis(out, document, extended_model_document(diagnosis, unchanged), page)
    return verdict_line(diagnosis)


def verdict_line(diagnosis: Diagnosis) -> str:
    """The verdict and what it rests on, in one line."""
    names = " and ".join(" or ".join(map(repr, (f.cause, *f.tied))) for f in diagnosis.findings)
    before, after = (1e6 * value for value in diagnosis.holdout_rmse)
    floor = 1e6 * diagnosis.problem.noise_floor
    if diagnosis.verdict == "consistent":
        return f"consistent: the residual of {before:.1f} um is the measurement noise ({floor:.1f} um)"
    if diagnosis.verdict == "unexplained":
        return f"unexplained: {before:.1f} um against {floor:.1f} um of noise, and no known cause earns its place"
    return f"{diagnosis.verdict}: {names}; held-out residual {before:.1f} -> {after:.1f} um, noise {floor:.1f} um"


def check_set(diagnosis: Diagnosis, other: MeasurementSet) -> dict[str, Any]:
    """Predict a set that no fit has seen."""
    problem = Problem(other)
    members, theta = diagnosis.extended.members, diagnosis.extended.theta
    everything = np.ones(len(other), dtype=bool)
    return {
        "set": other.path.name,
        "rows": len(other),
        "baseline": {"rmse": rmse(problem.predict((), np.zeros(0)).residual, everything)},
        "extended": {"rmse": rmse(problem.predict(members, theta).residual, everything)},
    }


def _trials(plan: NextMeasurement) -> list[dict[str, Any]]:
    return [
        {
            "q": trial.q.tolist(),
            "force": trial.force,
            "load_direction": f"base {trial.load}",
            "wrench": trial.wrench.tolist(),
            "last_motion": trial.direction,
            "reflector": trial.reflector,
            "expected_difference": trial.difference,
            "expected_log_odds": trial.information,
        }
        for trial in plan.trials
    ]
