"""What a diagnosis of poses tells of its causes: parameters, what leans on each, and why others are not named."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.account import NamedCause
from doormill_ros.diagnosis.core.wording import spoken
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis
from doormill_ros.diagnosis.pose.laws import CLEAR, numbers_told
from doormill_ros.diagnosis.pose.model import distinct_share, rmse
from doormill_ros.diagnosis.pose.problem import PoseProblem
from doormill_ros.diagnosis.pose.selection import NOT_CARRIED, ONE_SERIES, Score
from doormill_ros.measurements.pose_set import PoseSet, placement_owners
from doormill_ros.robot_model.pose.causes.joint_backlash import PoseBacklash
from doormill_ros.robot_model.pose.causes.joint_sag import JointSag
from doormill_ros.robot_model.pose.causes.joint_waves import JointWaves
from doormill_ros.robot_model.pose.causes.session_step import SessionStep
from doormill_ros.robot_model.pose.causes.tracker_scale import PoseTrackerScale
from doormill_ros.units import share_to_ppm

#: Why a cause that helps on blocks left out is not one of the robot.
WITHIN = (ONE_SERIES, NOT_CARRIED)
#: Part of a coefficient's effect that a placement cannot imitate, below which it is called not distinguishable.
IMITATED = 0.02


def place_name(diagnosis: PoseDiagnosis, where: str) -> str:
    """'set' alone when there is but one series."""
    return "set" if where.startswith("set ") and len(diagnosis.sets) == 1 else where


def causes_of(diagnosis: PoseDiagnosis) -> list[NamedCause]:
    """Established causes with parameters, and the gross errors."""
    found = []
    told, std = numbers_told(diagnosis)
    for score, doubles in zip(diagnosis.established, diagnosis.examination.doubles, strict=True):
        found.append(
            NamedCause(
                cause=score.cause.name,
                where=place_name(diagnosis, score.cause.where),
                words=spoken(score.cause),
                parameters=parameters_of(told, std, score),
                without=score.rmse_without,
                doubles=doubles,
                more={
                    "gain_by_series": [float(v) for v in score.gain],
                    "gain_with_series_left_out": [float(v) for v in score.transfer],
                },
            )
        )
    if not found:
        return []  # a consistent or an unexplained set names no cause; its gross errors stand under outliers
    for data, bad in zip(diagnosis.sets, diagnosis.gross, strict=True):
        if bad.any():
            rows = [int(row) for row in data.row[bad]]
            found.append(
                NamedCause(
                    cause="gross_error",
                    where=place_name(diagnosis, f"set {data.name}"),
                    words=f"gross errors in {data.name}",
                    parameters={"rows": {"value": rows, "std": [0.0] * len(rows), "unit": "-"}},
                    without=rmse(diagnosis.after.blocks, [np.ones(len(e), bool) for e in diagnosis.gross]),
                )
            )
    return found


def sides_of_gaps(causes: Sequence[NamedCause]) -> list[str]:
    """On every joint that has one, to which side it opens: the gap itself is a size."""
    said = {
        "short": "stops half its gap short of the recorded angle, as play behind the encoder does.",
        "beyond": "goes half its gap beyond the recorded angle, which play behind the encoder does not do.",
    }
    return [
        f"{one.where.capitalize()} {said[one.parameters['gap']['side']]}"
        for one in causes
        if one.cause == PoseBacklash.name
    ]


def scale_of_all(causes: Sequence[NamedCause]) -> list[str]:
    """What one share may be, by which all lengths are off."""
    return [
        "One share explains what otherwise lengths of several links would: all lengths are seen "
        f"{share_to_ppm(one.parameters['factor']['value'] - 1.0):+.0f} ppm off (standard deviation "
        f"{share_to_ppm(one.parameters['factor']['std']):.0f} ppm). The tracker's scale does that, and so does a "
        "robot that is warmer or colder than its drawing; poses do not tell them apart. Measure a scale bar of known "
        "length with the tracker."
        for one in causes
        if one.cause == PoseTrackerScale.name
    ]


def parameters_of(told: PoseProblem, deviation: FloatArray, score: Score) -> dict[str, dict[str, Any]]:
    """Value, standard deviation and unit by name.

    Args:
        told: With the numbers that are told.
        deviation: Standard deviation of every coefficient, shape (m,).
        score: Of the cause.
    """
    layout = told.layout
    index = layout.causes.index(score.cause)
    value, std = told.x[layout.part(index)], deviation[layout.part(index)]
    coefficients = score.cause.coefficients
    named: dict[str, dict[str, Any]] = {
        c.name: {"value": float(v), "std": float(s), "unit": c.unit}
        for c, v, s in zip(coefficients, value, std, strict=True)
    }
    if isinstance(score.cause, SessionStep):
        data = next(d for d in told.sets if score.cause.where == f"set {d.name}")
        at = int(np.searchsorted(data.row, score.cause.row))
        series = next(i for i, d in enumerate(told.sets) if d is data)
        R_tracker_base = told.placements[series].T_tracker_base[:3, :3]
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
    if isinstance(score.cause, PoseBacklash):
        gap = named["gap"]
        return {"gap": {**gap, "value": abs(gap["value"]), "side": PoseBacklash.side(gap["value"])}}
    if isinstance(score.cause, PoseTrackerScale):
        return {name: {**one, "value": 1.0 + one["value"]} for name, one in named.items()}
    if isinstance(score.cause, JointSag) and score.cause.frames:
        # Most moments of a real arm are next to nothing.
        return {name: one for name, one in named.items() if abs(one["value"]) > CLEAR * one["std"]}
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
            if size > CLEAR * std:
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


def rejected_entry(score: Score) -> dict[str, Any]:
    """A cause that did not earn its place, for diagnosis.json."""
    return {
        "cause": score.cause.name,
        "where": score.cause.where,
        "why": score.status,
        "gain_by_series": [float(v) for v in score.gain],
        "standard_errors_by_series": [float(v) for v in score.sure],
        "gain_with_series_left_out": [float(v) for v in score.transfer],
        "position_standard_errors": float(score.position_sure),
    }


def not_determined(sets: Sequence[PoseSet]) -> list[dict[str, Any]]:
    """What no row of a placement tells, of every series whose target was seen as a point."""
    owners = placement_owners(sets)
    return [
        {
            "what": "orientation of the target on the flange",
            "where": f"set {data.name}",
            "why": "positions alone were measured",
        }
        for data, own in zip(sets, owners, strict=True)
        if not any(one.oriented for one, other in zip(sets, owners, strict=True) if other == own)
    ]


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
            "where": f"link {diagnosis.sets[0].joints}",
            "parameters": ["theta", "d", "a", "alpha"],
            "imitated_by": "target on flange",
        },
    ]
    share = distinct_share(diagnosis.extended.fitted)
    for cause, part in diagnosis.extended.parts:
        names = [c.name for c, own in zip(cause.coefficients, share[part], strict=True) if own < IMITATED]
        if names and cause.of_robot:
            found.append(
                {"cause": cause.name, "where": cause.where, "parameters": names, "imitated_by": "placement"}
            )
    return found
