"""Series of poses: where a tracker saw the target of an unloaded robot questions its nominal model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.account import Account, told
from doormill_ros.diagnosis.core.document import cause_entry
from doormill_ros.diagnosis.core.kind import Kind, Progress
from doormill_ros.diagnosis.core.wording import Unit, Words
from doormill_ros.diagnosis.pose.causes import WITHIN, causes_of, indistinguishable, rejected_entry
from doormill_ros.diagnosis.pose.coverage import BINS, bin_of, coverage, covered
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis, check_together, diagnose_poses
from doormill_ros.diagnosis.pose.evidence import (
    candidates_blocks,
    closing,
    evidence,
    next_poses_table,
)
from doormill_ros.diagnosis.pose.fit import deviation
from doormill_ros.diagnosis.pose.model import Errors, rmse
from doormill_ros.diagnosis.pose.next_poses import listed, plan_next, propose
from doormill_ros.diagnosis.pose.placement import fit_placement
from doormill_ros.measurements.pose_set import SCHEMA, PoseSet, read_pose_set
from doormill_ros.robot_model.pose.chain import frames, residual
from doormill_ros.robot_model.pose.model import model_document

#: A checked row this many expected deviations off counts as a gross error.
_GROSS = 7.0
#: Position errors are three-dimensional lengths, far above a tenth of a micrometre.
UNIT = Unit("m", "um", digits=0)

METHOD = """Every series has a placement of its own: base in tracker and target on flange. Each cause displaces
the robot's frames a little, in proportion to its numbers; all are fitted together by weighted least squares that
gross errors cannot steer. How large the numbers of a kind usually are is learnt from the data, so that what the data
do not call for vanishes. Each series is cut into ten contiguous blocks, every fifth block is predicted by a fit that
has not seen it; whole series are predicted with only the placement fitted, on rows marked for that. A cause is named
if taking it away makes the blocks left out worse by more than their scatter allows, in more than one series where
there are several."""


class Poses(Kind[PoseSet, PoseDiagnosis]):
    """Series of poses of one robot, each with a placement of its own.

    Hundreds of coefficients are fitted at once and their sizes learnt: everything that may act is in from the start,
    and what the core's search leaves is named.
    """

    schema = SCHEMA

    def read(self, folder: Path, progress: Progress) -> Sequence[PoseSet]:
        """The series in a folder."""
        return [read_pose_set(folder)]

    def check_together(self, sets: Sequence[PoseSet], others: Sequence[PoseSet]) -> None:
        """One robot and one nominal table."""
        check_together([*sets, *others])

    def diagnose(self, sets: Sequence[PoseSet], progress: Progress) -> PoseDiagnosis:
        """Fit everything that may act, and keep what earns its place on rows left out."""
        return diagnose_poses(sets, progress)

    def check(self, diagnosis: PoseDiagnosis, other: PoseSet) -> dict[str, Any]:
        """Placed by its marked rows, the others are predicted."""
        return check_set(diagnosis, other)

    def account(
        self,
        diagnosis: PoseDiagnosis,
        sets: Sequence[PoseSet],
        checks: Sequence[Mapping[str, Any]],
        progress: Progress,
    ) -> Account:
        """Every rmse is a 3-D position error and stands beside its rotation_rmse."""
        progress("choosing poses to measure next")
        poses = propose(diagnosis)
        causes = causes_of(diagnosis)
        series = [cause_entry(cause) for cause in causes if cause.where.startswith("set")]
        source = f"diagnosis of {', '.join(one.name for one in sets)}, verdict {diagnosis.verdict}"
        sections = {**_sections(diagnosis), "next_poses": listed(poses)}
        after = _figures(diagnosis, diagnosis.after)
        unseen = after.get("series_out_rmse")
        return told(
            diagnosis,
            Words(f"model of {sets[0].robot}", "poses", "position error", "error", "blocks", METHOD),
            UNIT,
            diagnosis.noise_floor,
            causes,
            baseline=_figures(diagnosis, diagnosis.before),
            extended=after,
            rows=sum(len(one) for one in sets),
            outliers=[
                int(row)
                for data, bad in zip(diagnosis.sets, diagnosis.gross, strict=True)
                for row in data.row[bad]
            ],
            remarks=_remarks(diagnosis),
            next_measurement=plan_next(diagnosis, poses),
            checks=checks,
            sections=sections,
            model=model_document(diagnosis.model, source, series),
            evidence=evidence(diagnosis, sections["sets"]),
            candidates=candidates_blocks(diagnosis, sections),
            next_blocks=next_poses_table(sections["next_poses"]),
            closing=closing(diagnosis, sections, checks),
            tiles=[] if unseen is None else [(UNIT.spoken(unseen), "extended model on unseen series")],
        )


def _figures(diagnosis: PoseDiagnosis, errors: Errors) -> dict[str, float]:
    kept = [~bad for bad in diagnosis.gross]
    found: dict[str, float] = {}
    for part, residuals in (
        ("train", errors.train),
        ("holdout", errors.blocks),
        ("series_out", errors.series),
    ):
        if residuals:
            found[f"{part}_rmse"] = rmse(residuals, kept)
            found[f"{part}_rotation_rmse"] = rmse(residuals, kept, rotation=True)
    return found | {"rotation_rmse": found["holdout_rotation_rmse"]}


def _sections(diagnosis: PoseDiagnosis) -> dict[str, Any]:
    """What diagnosis.json says of poses beyond what it says of every kind of data."""
    return {
        "outliers_by_set": {
            data.name: [int(row) for row in data.row[bad]]
            for data, bad in zip(diagnosis.sets, diagnosis.gross, strict=True)
            if bad.any()
        },
        "sets": [_series(diagnosis, index) for index in range(len(diagnosis.sets))],
        "only_within_one_series": [
            rejected_entry(score) for score in diagnosis.rejected if score.status in WITHIN
        ],
        "rejected": [rejected_entry(score) for score in diagnosis.rejected if score.status not in WITHIN],
        "not_distinguishable_from_placement": indistinguishable(diagnosis),
        "coverage": coverage(diagnosis),
    }


def _series(diagnosis: PoseDiagnosis, index: int) -> dict[str, Any]:
    data, kept = diagnosis.sets[index], [~diagnosis.gross[index]]
    entry: dict[str, Any] = {
        "set": data.name,
        "rows": len(data),
        "gross_errors": int(diagnosis.gross[index].sum()),
    }
    for name, errors in (("baseline", diagnosis.before), ("extended", diagnosis.after)):
        entry[name] = {
            "train_rmse": rmse([errors.train[index]], kept),
            "holdout_rmse": rmse([errors.blocks[index]], kept),
            "rotation_rmse": rmse([errors.blocks[index]], kept, rotation=True),
        }
        if errors.series:
            entry[name]["series_out_rmse"] = rmse([errors.series[index]], kept)
            entry[name]["series_out_rotation_rmse"] = rmse([errors.series[index]], kept, rotation=True)
    return entry


def _remarks(diagnosis: PoseDiagnosis) -> list[str]:
    """Sentences for the reader."""
    lines = [
        "Position errors are 3-D lengths; rows listed as gross errors count in no figure.",
        "Away from the joint angles listed under coverage the periodic errors fade and nothing is claimed.",
    ]
    if not any(data.links for data in diagnosis.sets) and diagnosis.extended.problem.views[0].links:
        lines.append("The sets state no masses; gravity torques use the maker's published ones.")
    if not diagnosis.extended.problem.views[0].links:
        lines.append("No masses are known: sag under gravity could not be asked for.")
    if len(diagnosis.sets) == 1:
        lines.append("With a single series nothing shows whether a cause holds beyond it.")
    return lines


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
