"""Predicts a set that no fit has seen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from doormill_ros.diagnosis.pose.coverage import BINS, bin_of, covered
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis
from doormill_ros.diagnosis.pose.fitting.fit import deviation
from doormill_ros.diagnosis.pose.fitting.model import figures
from doormill_ros.diagnosis.pose.fitting.noise import expected
from doormill_ros.diagnosis.pose.fitting.placement import Seen, place_together
from doormill_ros.diagnosis.pose.laws import model_with_laws, placements_with_laws
from doormill_ros.measurements.sets.pose_set import PoseSet, placement_owners
from doormill_ros.robot_model.pose.chain import Placement, frames, residual
from doormill_ros.robot_model.pose.model import PoseModel

#: A checked row this many expected deviations off counts as a gross error.
_GROSS = 7.0


def check_set(diagnosis: PoseDiagnosis, other: PoseSet, checked: Sequence[PoseSet] = ()) -> dict[str, Any]:
    """Predict a set that no fit has seen.

    Where it has the placement of a diagnosed set, all its rows are predicted by that one's. Otherwise its marked rows
    place it, together with those of checked sets that have the same placement, and the others are predicted.

    Args:
        diagnosis: Of other sets.
        other: The set.
        checked: All sets that are checked together, where sets may share a placement.

    Raises:
        PosePlacementError: Too few marked rows.
        SetDescriptionError: It has the placement of a set that is not given.
    """
    sets = list(diagnosis.sets)
    others = [*checked] if any(one is other for one in checked) else [*checked, other]
    owner = placement_owners([*sets, *others])
    mine = owner[len(sets) + next(i for i, one in enumerate(others) if one is other)]
    company = [one for one, own in zip(others, owner[len(sets) :], strict=True) if own == mine]
    known = mine < len(sets)
    rest = np.ones(len(other), dtype=bool) if known else ~other.placement
    rest = rest if rest.any() else np.ones(len(other), dtype=bool)
    marked = np.zeros(len(other), dtype=bool) if known else other.placement
    errors = {}
    models: dict[str, PoseModel | None] = {"baseline": None, "extended": diagnosis.model}
    if diagnosis.laws is not None:
        models["characterised"] = model_with_laws(diagnosis)
    for name, model in models.items():
        problem = (diagnosis.baseline if model is None else diagnosis.extended).problem
        sigma = expected(other, problem.sets, problem.sigmas)
        placements = placements_with_laws(diagnosis) if name == "characterised" else problem.placements

        def modelled(one: PoseSet, model: PoseModel | None = model) -> np.ndarray:
            return frames(one.view.transforms) if model is None else model.frames(one.view)

        placement: Placement = (
            placements[mine]
            if known
            else place_together([_marked(modelled(one), one) for one in company], sigma)
        )
        errors[name] = residual(modelled(other), placement, other.position, other.rotation)
    sigma = expected(other, diagnosis.sets, diagnosis.extended.problem.sigmas)
    size = deviation(errors["extended"], sigma, other.oriented)
    scale = max(1.0, float(np.median(size)))
    gross = rest & (size > _GROSS * scale)
    entry: dict[str, Any] = {"set": other.name, "rows": int(rest.sum()), "placement_rows": int(marked.sum())}
    for name, error in errors.items():
        entry[name] = _figures(other, error, rest)
    entry["gross_errors"] = [int(row) for row in other.row[gross]]
    entry["extended_without_gross_errors"] = _figures(other, errors["extended"], rest & ~gross)
    joints = range(other.joints)
    visited = [covered(np.concatenate([data.q[:, k] for data in diagnosis.sets])) for k in joints]
    entry["outside_coverage"] = {
        f"joint {k + 1}": float(np.mean(~visited[k][bin_of(other.q[:, k])])) for k in joints
    }
    entry["bins_of_a_turn"] = BINS
    return entry


def _marked(T_base_frames: np.ndarray, data: PoseSet) -> Seen:
    rows = data.placement
    rotation = None if data.rotation is None else data.rotation[rows]
    return Seen(T_base_frames[rows], data.position[rows], rotation)


def _figures(data: PoseSet, error: np.ndarray, rows: np.ndarray) -> dict[str, float]:
    position, rotation = figures([data], [error], [rows])
    return {"rmse": position} | ({} if rotation is None else {"rotation_rmse": rotation})
