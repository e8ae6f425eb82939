"""Doors asked once more beside what all of them show alike, and what is told of that."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.kind import Progress
from doormill_ros.diagnosis.core.verdict import PARTLY_EXPLAINED, UNEXPLAINED, rmse
from doormill_ros.diagnosis.parts.discrepancy import DISCREPANCIES
from doormill_ros.diagnosis.parts.problem import DoorDiagnosis, DoorProblem
from doormill_ros.statistics import bootstrap_ratio
from doormill_ros.units import m_to_um

#: Questions doors.
Ask = Callable[[DoorProblem, Progress], DoorDiagnosis]
#: Share of what named causes leave beyond noise that may be left beside a discrepancy, to ask beside it.
_MAIN = 0.5


def asked_beside(found: DoorDiagnosis, ask: Ask, progress: Progress) -> DoorDiagnosis:
    """Where doors show more than noise, what is said beside the first discrepancy that leaves noise; else the same.

    Args:
        found: What is said of the doors without one.
        ask: Questions the doors.
        progress: Told of every step.
    """
    problem, best, extended = found.problem, found.best, found.extended
    known = all(member.named for member in best.members) and found.question.at_noise(best)
    if known or found.verdict not in (PARTLY_EXPLAINED, UNEXPLAINED):
        return found
    recurring = len(problem.doors) / len({door.recipe for door in problem.doors})
    before = problem.excess(extended.members, extended.theta)
    for kind in DISCREPANCIES:
        discrepancy = kind(problem.off)
        beside = problem.beside(discrepancy)
        left = beside.excess(extended.members, extended.theta)
        if recurring < discrepancy.recurring or left > _MAIN * before:
            continue
        progress(f"asking beside what every door may show alike: {discrepancy.acts_on}")
        other = ask(beside, progress)
        keys = {finding.cause.key for finding in other.findings}
        # What it could be itself is not given up for it; any other name was given beside more than noise.
        asked = [one for one in found.findings if discrepancy.could_be(one.cause.effect)]
        if other.question.at_noise(other.extended) and all(one.cause.key in keys for one in asked):
            return with_discrepancy(other)
    return found


def with_discrepancy(found: DoorDiagnosis) -> DoorDiagnosis:
    """The same with figures and verdict of the doors without their discrepancy: a law without a name is no name."""
    plain, kept, question = found.problem.beside(None), found.kept, found.question
    pair = found.baseline, found.extended
    left = [plain.predict(model.members, model.theta).residual for model in pair]
    # What a model loses on rows left out it loses with a discrepancy and without.
    unseen = [
        replace(model, held_out=seen + model.held_out - model.prediction.residual)
        for model, seen in zip(pair, left, strict=True)
    ]
    train = [rmse(seen, kept, plain.components) for seen in left]
    before, after = (question.holdout_squares(model, kept) for model in unseen)
    ratio, interval = bootstrap_ratio(before, after)
    return replace(
        found,
        verdict=PARTLY_EXPLAINED if found.findings else UNEXPLAINED,
        train_rmse=(train[0], train[1]),
        holdout_rmse=(question.holdout_rmse(unseen[0], kept), question.holdout_rmse(unseen[1], kept)),
        ratio=ratio,
        ratio_ci=interval,
    )


def unnamed_document(diagnosis: DoorDiagnosis) -> dict[str, Any]:
    """`unnamed` and `characterised` of diagnosis.json; nothing where nothing was asked beside a discrepancy."""
    problem, kept = diagnosis.problem, diagnosis.kept
    if problem.discrepancy is None:
        return {}
    squares = diagnosis.question.holdout_squares(diagnosis.extended, kept)
    _, (low, high) = bootstrap_ratio(np.full(len(squares), squares.mean()), squares)
    value = diagnosis.question.holdout_rmse(diagnosis.extended, kept)
    law = {
        "where": problem.discrepancy.where,
        "acts_on": problem.discrepancy.acts_on,
        "driver": problem.discrepancy.driver,
        "law": _law(diagnosis),
        "holdout_rmse_without": diagnosis.holdout_rmse[1],
        "rivals": [],
        "test": problem.discrepancy.test,
    }
    return {
        "unnamed": [law],
        "characterised": {"holdout_rmse": value, "ci95": [value * low, value * high]},
    }


def unnamed_sentences(diagnosis: DoorDiagnosis) -> list[str]:
    """What of it the report says."""
    discrepancy = diagnosis.problem.discrepancy
    if discrepancy is None:
        return []
    left = diagnosis.question.holdout_rmse(diagnosis.extended, diagnosis.kept)
    return [
        f"Without a name: {_law(diagnosis)}; beside that the doors leave {m_to_um(left):.1f} um. {discrepancy.hides}",
        f"What it is: {discrepancy.test}.",
    ]


def _law(diagnosis: DoorDiagnosis) -> str:
    discrepancy = diagnosis.problem.discrepancy
    assert discrepancy is not None  # asked by those who looked
    left = diagnosis.question.train_rmse(diagnosis.extended, diagnosis.kept)
    size = np.sqrt(max(diagnosis.train_rmse[1] ** 2 - left**2, 0.0))
    return f"{discrepancy.words}, by {m_to_um(size):.0f} um root mean square"
