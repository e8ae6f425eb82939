"""Runs a whole diagnosis of measurement sets and writes its files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.document import diagnosis_document, write_diagnosis
from doormill_ros.diagnosis.core.margins import margins
from doormill_ros.diagnosis.core.verdict import rmse, spoken_verdict
from doormill_ros.diagnosis.loading.diagnosis import LoadingDiagnosis, diagnose_set
from doormill_ros.diagnosis.loading.next_measurement import NextMeasurement, plan_next
from doormill_ros.diagnosis.loading.path_shift import doubt, path_shift
from doormill_ros.diagnosis.loading.problem import LoadingProblem
from doormill_ros.diagnosis.loading.report import render_report
from doormill_ros.measurements.join_sets import check_same_model, join_sets
from doormill_ros.measurements.measurement_set import MeasurementSet, read_measurement_set
from doormill_ros.robot_model.extended_model import SizedCause, model_document


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
    write_diagnosis(out, document, extended_model_document(diagnosis, joined.path.name, unchanged), page)
    return verdict_line(diagnosis)


def extended_model_document(diagnosis: LoadingDiagnosis, source: str, unchanged: str = "") -> dict[str, Any]:
    """The content of model.yaml; without any cause where there is a reason for that."""
    data = diagnosis.problem.data
    return model_document(
        data.robot,
        data.joint_stiffness,
        [] if unchanged else [SizedCause(finding.cause, finding.values) for finding in diagnosis.findings],
        f"diagnosis of {source}, verdict {diagnosis.verdict}",
        unchanged,
    )


def verdict_line(diagnosis: LoadingDiagnosis) -> str:
    """The verdict and what it rests on, in one line."""
    return spoken_verdict(
        diagnosis.verdict,
        " and ".join(" or ".join(map(repr, (f.cause, *f.tied))) for f in diagnosis.findings),
        [f"{1e6 * value:.1f}" for value in (*diagnosis.holdout_rmse, diagnosis.problem.noise_floor)],
        "residual",
        "residual",
    )


def check_set(diagnosis: LoadingDiagnosis, other: MeasurementSet) -> dict[str, Any]:
    """Predict a set that no fit has seen."""
    problem = LoadingProblem(other)
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
