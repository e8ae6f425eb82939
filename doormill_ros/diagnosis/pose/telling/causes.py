"""What a diagnosis of poses tells of its causes: parameters, what leans on each, and why others are not named."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.examining.examination import Double
from doormill_ros.diagnosis.core.telling.account import NamedCause
from doormill_ros.diagnosis.core.words.wording import spoken
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis
from doormill_ros.diagnosis.pose.fitting.model import distinct_share, rmse
from doormill_ros.diagnosis.pose.fitting.problem import PoseProblem
from doormill_ros.diagnosis.pose.laws import numbers_told
from doormill_ros.diagnosis.pose.searching.selection import NOT_CARRIED, ONE_SERIES, Score
from doormill_ros.measurements.sets.pose_set import PoseSet, placement_owners
from doormill_ros.robot_model.pose.causes.cause import PoseCause

#: Why a cause that helps on blocks left out is not one of the robot.
WITHIN = (ONE_SERIES, NOT_CARRIED)
#: Part of a coefficient's effect that a placement cannot imitate, below which it is called not distinguishable.
IMITATED = 0.02


def place_name(sets: Sequence[PoseSet], where: str) -> str:
    """'set' alone when there is but one series."""
    return "set" if where.startswith("set ") and len(sets) == 1 else where


def causes_of(diagnosis: PoseDiagnosis) -> list[NamedCause]:
    """Established causes with parameters, and the gross errors."""
    found = []
    told, std = numbers_told(diagnosis)
    for score, doubles in zip(diagnosis.established, diagnosis.examination.doubles, strict=True):
        found.append(
            NamedCause(
                cause=score.cause.name,
                where=place_name(diagnosis.sets, score.cause.where),
                words=spoken(score.cause),
                parameters=parameters_of(told, std, score),
                without=score.rmse_without,
                doubles=[_placed(diagnosis.sets, double) for double in doubles],
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
                    where=place_name(diagnosis.sets, f"set {data.name}"),
                    words=f"gross errors in {data.name}",
                    parameters={"rows": {"value": rows, "std": [0.0] * len(rows), "unit": "-"}},
                    without=rmse(diagnosis.after.blocks, [np.ones(len(e), bool) for e in diagnosis.gross]),
                )
            )
    return found


def _placed(sets: Sequence[PoseSet], double: Double[PoseCause, Any]) -> Double[PoseCause, Any]:
    """A double with the name of its place as causes have it."""
    cause = copy(double.cause)
    cause.where = place_name(sets, cause.where)
    return replace(double, cause=cause)


def doubts(diagnosis: PoseDiagnosis, told: Sequence[NamedCause]) -> list[str]:
    """What else established causes may be, as sentences."""
    pairs = zip(diagnosis.established, told, strict=False)  # gross errors follow
    return [line for score, one in pairs if (line := score.cause.doubt(one.parameters))]


def meanings(diagnosis: PoseDiagnosis, told: Sequence[NamedCause]) -> list[str]:
    """What numbers of established causes mean, as sentences."""
    pairs = zip(diagnosis.established, told, strict=False)
    return [line for score, one in pairs if (line := score.cause.meaning(one.parameters))]


def parameters_of(told: PoseProblem, deviation: FloatArray, score: Score) -> dict[str, dict[str, Any]]:
    """Value, standard deviation and unit by name.

    Args:
        told: With the numbers that are told.
        deviation: Standard deviation of every coefficient, shape (m,).
        score: Of the cause.
    """
    part = told.layout.part(told.layout.causes.index(score.cause))
    seen = list(zip(told.views, told.placements, strict=True))
    return score.cause.reported(told.x[part], deviation[part], seen)


def rejected_entry(diagnosis: PoseDiagnosis, score: Score) -> dict[str, Any]:
    """A cause that did not earn its place, for diagnosis.json."""
    return {
        "cause": score.cause.name,
        "where": place_name(diagnosis.sets, score.cause.where),
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
            "where": place_name(sets, f"set {data.name}"),
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
