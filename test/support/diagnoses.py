"""Diagnoses of data in memory, which no command reads from a folder."""

from __future__ import annotations

from collections.abc import Callable

from doormill_ros.diagnosis.camera.problem import CameraDiagnosis, PictureProblem
from doormill_ros.diagnosis.core.diagnosis import diagnose_problem
from doormill_ros.diagnosis.loading.problem import LoadingDiagnosis, LoadingProblem
from doormill_ros.measurements.picture_reading import Localisations
from doormill_ros.measurements.trials import Trials


def diagnose_pictures(data: Localisations) -> CameraDiagnosis:
    """Question a camera model with localisations of a door moved by known amounts."""
    return diagnose_problem(PictureProblem(data))


def diagnose_set(data: Trials, progress: Callable[[str], None] = lambda line: None) -> LoadingDiagnosis:
    """Question the simulation of one loading test."""
    return diagnose_problem(LoadingProblem(data), progress)
