"""The content of diagnosis.json for poses."""

from __future__ import annotations

from typing import Any

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.diagnosis.core.document import MODEL_FILE, SCHEMA
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis, distinct_share, rmse
from doormill_ros.diagnosis.pose.selection import NOT_CARRIED, ONE_SERIES, Score
from doormill_ros.robot_model.pose.causes.joint_waves import JointWaves
from doormill_ros.robot_model.pose.causes.session_step import SessionStep

#: Why a cause that helps on blocks left out is not one of the robot.
WITHIN = (ONE_SERIES, NOT_CARRIED)
#: Amplitudes of single orders are listed from this many standard deviations.
LISTED = 2.0
#: Part of a coefficient's effect that a placement cannot imitate, below which it is called not distinguishable.
IMITATED = 0.02


def pose_document(
    diagnosis: PoseDiagnosis,
    next_measurement: str,
    next_poses: list[dict[str, Any]],
    checks: list[dict[str, Any]],
) -> dict[str, Any]:
    """The content of diagnosis.json; every rmse is a 3-D position error and stands beside its rotation_rmse."""
    kept = [~bad for bad in diagnosis.gross]
    before, after = diagnosis.before, diagnosis.after
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "verdict": diagnosis.verdict,
        "noise_floor": diagnosis.noise_floor,
    }
    for name, errors in (("baseline", before), ("extended", after)):
        document[name] = {}
        for part, residuals in (
            ("train", errors.train),
            ("holdout", errors.blocks),
            ("series_out", errors.series),
        ):
            if residuals:
                document[name][f"{part}_rmse"] = rmse(residuals, kept)
                document[name][f"{part}_rotation_rmse"] = rmse(residuals, kept, rotation=True)
        document[name]["rotation_rmse"] = document[name]["holdout_rotation_rmse"]
    document["gain"] = {"holdout_rmse_ratio": diagnosis.ratio, "ci95": list(diagnosis.ratio_ci)}
    document["causes"] = causes_of(diagnosis)
    document["outliers"] = [
        int(row) for data, bad in zip(diagnosis.sets, diagnosis.gross, strict=True) for row in data.row[bad]
    ]
    document["outliers_by_set"] = {
        data.name: [int(row) for row in data.row[bad]]
        for data, bad in zip(diagnosis.sets, diagnosis.gross, strict=True)
        if bad.any()
    }
    document["sets"] = [_series(diagnosis, index) for index in range(len(diagnosis.sets))]
    document["only_within_one_series"] = [
        _rejected(score) for score in diagnosis.rejected if score.status in WITHIN
    ]
    document["rejected"] = [_rejected(score) for score in diagnosis.rejected if score.status not in WITHIN]
    document["not_distinguishable_from_placement"] = indistinguishable(diagnosis)
    document["coverage"] = coverage(diagnosis)
    document["next_measurement"] = next_measurement
    document["next_poses"] = next_poses
    document["extended_model"] = MODEL_FILE
    document["checks"] = checks
    document["remarks"] = remarks(diagnosis)
    return document


def place_name(diagnosis: PoseDiagnosis, where: str) -> str:
    """'set' alone when there is but one series."""
    return "set" if where.startswith("set ") and len(diagnosis.sets) == 1 else where


def causes_of(diagnosis: PoseDiagnosis) -> list[dict[str, Any]]:
    """Established causes with parameters, and the gross errors."""
    found = []
    confusable = confusions(diagnosis)
    for score in diagnosis.established:
        found.append(
            {
                "cause": score.cause.name,
                "where": place_name(diagnosis, score.cause.where),
                "parameters": parameters_of(diagnosis, score),
                "holdout_rmse_without": score.rmse_without,
                "confusable_with": confusable.get(score.cause.key, []),
                "gain_by_series": [float(v) for v in score.gain],
                "gain_with_series_left_out": [float(v) for v in score.transfer],
            }
        )
    if not found:
        return []  # a consistent or an unexplained set names no cause; its gross errors stand under outliers
    for data, bad in zip(diagnosis.sets, diagnosis.gross, strict=True):
        if bad.any():
            rows = [int(row) for row in data.row[bad]]
            found.append(
                {
                    "cause": "gross_error",
                    "where": place_name(diagnosis, f"set {data.name}"),
                    "parameters": {"rows": {"value": rows, "std": [0.0] * len(rows), "unit": "-"}},
                    "holdout_rmse_without": rmse(
                        diagnosis.after.blocks, [np.ones(len(e), bool) for e in diagnosis.gross]
                    ),
                    "confusable_with": [],
                }
            )
    return found


def parameters_of(diagnosis: PoseDiagnosis, score: Score) -> dict[str, dict[str, Any]]:
    """Value, standard deviation and unit by name."""
    layout = diagnosis.extended.problem.layout
    index = layout.causes.index(score.cause)
    value = diagnosis.extended.problem.x[layout.part(index)]
    std = diagnosis.std[layout.part(index)]
    coefficients = score.cause.coefficients
    named = {
        c.name: {"value": float(v), "std": float(s), "unit": c.unit}
        for c, v, s in zip(coefficients, value, std, strict=True)
    }
    if isinstance(score.cause, SessionStep):
        data = next(d for d in diagnosis.sets if score.cause.where == f"set {d.name}")
        at = int(np.searchsorted(data.row, score.cause.row))
        series = next(i for i, d in enumerate(diagnosis.sets) if d is data)
        R_tracker_base = diagnosis.extended.problem.placements[series].T_tracker_base[:3, :3]
        steps: dict[str, dict[str, Any]] = {}
        for name, axes in (("step", slice(0, 3)), ("turn", slice(3, 6))):
            steps[name] = {
                "value": [float(v) for v in R_tracker_base @ value[axes]],
                "std": [float(v) for v in np.sqrt(R_tracker_base**2 @ std[axes] ** 2)],
                "unit": coefficients[axes.start].unit,
                "axes": "tracker",
            }
        steps["row"] = {"value": score.cause.row, "std": 1.0, "unit": "-"}
        if np.isfinite(data.time[at]):
            steps["time"] = {
                "value": float(data.time[at]),
                "std": float(data.time[at] - data.time[at - 1]),
                "unit": "s",
            }
        return steps
    if isinstance(score.cause, JointWaves):
        return _amplitudes(named, [c.name for c in coefficients], score.cause.orders)
    return named


def _amplitudes(
    named: dict[str, dict[str, Any]], names: list[str], orders: tuple[int, ...]
) -> dict[str, dict[str, Any]]:
    found = {}
    for prefix in dict.fromkeys(
        name.rsplit("_", 2)[0] + "_" if name.count("_") > 1 else "" for name in names
    ):
        for order in orders:
            c, s = named[f"{prefix}cos_{order}"], named[f"{prefix}sin_{order}"]
            size = float(np.hypot(c["value"], s["value"]))
            std = float(np.hypot(c["value"] * c["std"], s["value"] * s["std"]) / max(size, 1e-30))
            if size > LISTED * std:
                found[f"{prefix}order_{order}"] = {
                    "value": size,
                    "std": std,
                    "unit": "rad",
                    "cos": c["value"],
                    "sin": s["value"],
                    "cos_std": c["std"],
                    "sin_std": s["std"],
                }
    return found


def confusions(diagnosis: PoseDiagnosis) -> dict[tuple[str, str], list[dict[str, str]]]:
    """Other causes that leave, for a small loss, the same pattern: by the overlap of their effects."""
    fitted = diagnosis.extended
    layout = fitted.problem.layout
    C = fitted.solution.covariance
    x = fitted.problem.x
    found: dict[tuple[str, str], list[dict[str, str]]] = {}
    for i, cause in enumerate(layout.causes):
        a = layout.part(i)
        for j, other in enumerate(layout.causes):
            if i == j:
                continue
            b = layout.part(j)
            # How much surer the cause would be if the other were known.
            Cab = C[a, b]
            known = C[a, a] - Cab @ np.linalg.lstsq(C[b, b], Cab.T, rcond=1e-12)[0]
            now = float(x[a] @ C[a, a] @ x[a])
            then = float(x[a] @ known @ x[a])
            if now > 0.0 and then < 0.1 * now:
                found.setdefault(cause.key, []).append({"cause": other.name, "where": other.where})
    return found


def _rejected(score: Score) -> dict[str, Any]:
    return {
        "cause": score.cause.name,
        "where": score.cause.where,
        "why": score.status,
        "gain_by_series": [float(v) for v in score.gain],
        "standard_errors_by_series": [float(v) for v in score.sure],
        "gain_with_series_left_out": [float(v) for v in score.transfer],
        "position_standard_errors": float(score.position_sure),
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


def indistinguishable(diagnosis: PoseDiagnosis) -> list[dict[str, Any]]:
    """Parameters that a shifted robot or target would imitate."""
    found: list[dict[str, Any]] = [
        {
            "cause": "link_geometry",
            "where": "link 1",
            "parameters": ["theta", "d"],
            "imitated_by": "base in tracker",
        },
        {
            "cause": "link_geometry",
            "where": "link 6",
            "parameters": ["theta", "d", "a", "alpha"],
            "imitated_by": "target on flange",
        },
    ]
    layout = diagnosis.extended.problem.layout
    share = distinct_share(diagnosis.extended)
    for index, cause in enumerate(layout.causes):
        names = [
            c.name
            for c, part in zip(cause.coefficients, share[layout.part(index)], strict=True)
            if part < IMITATED
        ]
        if names and cause.transfers:
            found.append(
                {"cause": cause.name, "where": cause.where, "parameters": names, "imitated_by": "placement"}
            )
    return found


def coverage(diagnosis: PoseDiagnosis) -> list[dict[str, Any]]:
    """Joint angles that were visited: turns of 360 deg / 72 with at least five rows, as ranges."""
    found = []
    for k in range(6):
        visited = covered(np.concatenate([data.q[:, k] for data in diagnosis.sets]))
        edges = np.flatnonzero(np.diff(np.concatenate([[False], visited, [False]]).astype(int)))
        ranges = [
            [float(a), float(b)] for a, b in (edges.reshape(-1, 2) * 2.0 * np.pi / BINS - np.pi).tolist()
        ]
        found.append({"joint": k + 1, "share_of_turn": float(visited.mean()), "ranges": ranges})
    return found


BINS = 72


def bin_of(angle: FloatArray) -> IntArray:
    """Bin of a turn in which each angle lies, shape (n,) [rad]."""
    return (np.floor((angle + np.pi) * BINS / (2.0 * np.pi)).astype(int)) % BINS


def covered(angle: FloatArray) -> BoolArray:
    """Which bins of a turn hold at least five rows, shape (72,)."""
    return np.bincount(bin_of(angle), minlength=BINS) >= 5


def remarks(diagnosis: PoseDiagnosis) -> list[str]:
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
