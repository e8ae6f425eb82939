"""A diagnosis of 120 trials against refitting every candidate with scipy's default least squares."""

from __future__ import annotations

import logging
import statistics
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from doormill_ros.diagnosis.loading.patterns import unnamed_patterns
from doormill_ros.diagnosis.loading.problem import LoadingProblem as Problem
from doormill_ros.measurements.sets.measurement_set import MeasurementSet, read_measurement_set
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.elastic.causes.registry import candidates
from harness import Entry, entry
from support.diagnoses import diagnose_set
from support.truth.loading_test import draw_plan, write_loading_test

HIDDEN = {"cause": "joint_backlash", "where": "joint 1", "parameters": {"gap": 6e-5, "crossing": 60.0}}


def make_set(folder: Path) -> MeasurementSet:
    """120 trials, a backlash in joint 1."""
    rng = np.random.default_rng(7)
    plan = draw_plan(rng, load_robot("irb6600_175_255").dh, trials=120, postures=15)
    write_loading_test(folder, plan, [HIDDEN], rng)
    return read_measurement_set(folder)


def refit_everything(data: MeasurementSet) -> tuple[ElasticCause, np.ndarray, float]:
    """Every candidate alone, fitted and cross-validated by scipy with its finite differences."""
    problem = Problem(data)
    patterns = unnamed_patterns(data.q, data.time, data.temperature, data.dt)
    best: tuple[float, ElasticCause, np.ndarray] | None = None
    for cause in [*candidates(data.reflectors), *patterns]:

        def white(theta: np.ndarray, rows: np.ndarray, cause: ElasticCause = cause) -> np.ndarray:
            return problem.predict([cause], theta).white[rows].ravel()

        everything = np.ones(len(data), dtype=bool)
        bounds = (cause.lower - 1e-9, cause.upper + 1e-9)
        fits = [
            least_squares(white, start, bounds=bounds, args=(everything,))
            for start in cause.starts(problem.case)
        ]
        found = min(fits, key=lambda f: f.cost)
        held_out = 0.0
        for fold in range(problem.folds.max() + 1):
            rows = problem.folds == fold
            part = least_squares(white, found.x, bounds=bounds, args=(~rows,))
            held_out += float(np.sum(white(part.x, rows) ** 2))
        total = held_out + (np.log(3.0 * len(data)) - 2.0) * cause.size
        if best is None or total < best[0]:
            best = (total, cause, found.x)
    assert best is not None
    return best[1], best[1].values(best[2], problem.case), best[0]


def run() -> list[Entry]:
    """Time both; they must give the same answer."""
    logging.disable(logging.WARNING)
    with tempfile.TemporaryDirectory() as folder:
        data = make_set(Path(folder))
        diagnose_set(data)
        times = []
        for _ in range(5):
            start = time.perf_counter()
            diagnosis = diagnose_set(data)
            times.append(time.perf_counter() - start)
        start = time.perf_counter()
        cause, values, _ = refit_everything(data)
        peer = time.perf_counter() - start
    finding = diagnosis.findings[0]
    if cause.key != finding.cause.key or np.any(np.abs(values - finding.values) > 0.2 * finding.std):
        raise RuntimeError(f"different answers: {finding.cause!r} {finding.values} and {cause!r} {values}")
    return [
        entry(
            "diagnosis of 120 trials, all causes and their combinations",
            statistics.median(times),
            "s",
            "scipy least_squares, every single candidate and fold, finite differences",
            peer,
            len(times),
        )
    ]
