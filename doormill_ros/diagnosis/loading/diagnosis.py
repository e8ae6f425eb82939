"""From a measurement set to a verdict: what is wrong, how sure, what the extended model gains."""

from __future__ import annotations

from collections.abc import Callable

from doormill_ros.diagnosis.core.diagnosis import Diagnosis, diagnose_problem
from doormill_ros.diagnosis.loading.problem import LoadingProblem
from doormill_ros.measurements.trials import Trials
from doormill_ros.robot_model.elastic.causes.cause import Cause

#: What is known of a robot that was loaded.
LoadingDiagnosis = Diagnosis[LoadingProblem, Cause]


def diagnose_set(data: Trials, progress: Callable[[str], None] = lambda line: None) -> LoadingDiagnosis:
    """Question the simulation of one loading test."""
    return diagnose_problem(LoadingProblem(data), progress)
