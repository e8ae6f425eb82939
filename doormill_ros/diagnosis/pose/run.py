"""Runs a whole diagnosis of pose sets and writes its files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.document import write_diagnosis
from doormill_ros.diagnosis.core.verdict import spoken_verdict
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis, check_together, diagnose_poses, rmse
from doormill_ros.diagnosis.pose.document import BINS, bin_of, covered, pose_document
from doormill_ros.diagnosis.pose.fit import deviation
from doormill_ros.diagnosis.pose.margins import margins
from doormill_ros.diagnosis.pose.next_poses import listed, plan_next, propose
from doormill_ros.diagnosis.pose.placement import fit_placement
from doormill_ros.diagnosis.pose.report import render_report
from doormill_ros.measurements.pose_set import PoseSet, read_pose_set
from doormill_ros.robot_model.pose.chain import frames, residual
from doormill_ros.robot_model.pose.model import model_document

#: A checked row this many expected deviations off counts as a gross error.
_GROSS = 7.0


def run_pose_sets(
    data: Sequence[Path], check: Sequence[Path], out: Path, progress: Callable[[str], None]
) -> str:
    """Diagnose series together, predict the series to check, write the results.

    Returns:
        The verdict in one line.

    Raises:
        DataSetError: A set cannot be read or placed, or the sets do not belong together; nothing is written.
    """
    sets = [read_pose_set(folder) for folder in data]
    others = [read_pose_set(folder) for folder in check]
    check_together([*sets, *others])
    diagnosis = diagnose_poses(sets, progress)
    progress("predicting the sets to check")
    checks = [check_set(diagnosis, other) for other in others]
    progress("choosing poses to measure next")
    poses = propose(diagnosis)
    sentence = plan_next(diagnosis, poses)
    progress("writing the report")
    document = pose_document(diagnosis, sentence, listed(poses), checks)
    document["margins"] = [margin.document() for margin in margins(diagnosis)]
    source = f"diagnosis of {', '.join(one.name for one in sets)}, verdict {diagnosis.verdict}"
    series = [c for c in document["causes"] if c["where"].startswith("set")]
    write_diagnosis(
        out, document, model_document(diagnosis.model, source, series), render_report(diagnosis, document)
    )
    return verdict_line(diagnosis)


def verdict_line(diagnosis: PoseDiagnosis) -> str:
    """The verdict and what it rests on, in one line."""
    kept = [~bad for bad in diagnosis.gross]
    before = rmse(diagnosis.before.blocks, kept)
    after = rmse(diagnosis.after.blocks, kept)
    names: dict[str, list[str]] = {}
    for score in diagnosis.established:
        names.setdefault(score.cause.name.replace("_", " "), []).append(score.cause.where)
    listed = "; ".join(f"{name} ({', '.join(places)})" for name, places in names.items())
    figures = [f"{1e6 * value:.0f}" for value in (before, after, diagnosis.noise_floor)]
    return spoken_verdict(diagnosis.verdict, listed, figures, "position error", "error")


def check_set(diagnosis: PoseDiagnosis, other: PoseSet) -> dict[str, Any]:
    """Predict a set that no fit has seen; its marked rows place it, the others are predicted.

    Raises:
        PosePlacementError: Too few marked rows.
    """
    view = other.view
    sigma = diagnosis.extended.problem.sigma
    marked, rest = other.placement, ~other.placement
    rest = rest if rest.any() else np.ones(len(other), dtype=bool)
    errors = {}
    for name, T, spread in (
        ("baseline", frames(view.transforms), diagnosis.baseline.problem.sigma),
        ("extended", diagnosis.model.frames(view), sigma),
    ):
        placement = fit_placement(T[marked], other.position[marked], other.rotation[marked], spread)
        errors[name] = residual(T, placement, other.position, other.rotation)
    visited = [covered(np.concatenate([data.q[:, k] for data in diagnosis.sets])) for k in range(6)]
    outside = [float(np.mean(~visited[k][bin_of(other.q[:, k])])) for k in range(6)]
    size = deviation(errors["extended"], sigma)
    scale = max(1.0, float(np.median(size)))
    gross = rest & (size > _GROSS * scale)
    entry: dict[str, Any] = {"set": other.name, "rows": int(rest.sum()), "placement_rows": int(marked.sum())}
    for name, error in errors.items():
        entry[name] = {"rmse": rmse([error], [rest]), "rotation_rmse": rmse([error], [rest], rotation=True)}
    entry["gross_errors"] = [int(row) for row in other.row[gross]]
    entry["extended_without_gross_errors"] = {
        "rmse": rmse([errors["extended"]], [rest & ~gross]),
        "rotation_rmse": rmse([errors["extended"]], [rest & ~gross], rotation=True),
    }
    entry["outside_coverage"] = {f"joint {k + 1}": outside[k] for k in range(6)}
    entry["bins_of_a_turn"] = BINS
    return entry
