"""Doors asked once more beside what all of them show alike, and what is told of that."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.kind import Progress
from doormill_ros.diagnosis.core.words.verdict import PARTLY_EXPLAINED, UNEXPLAINED, rmse
from doormill_ros.diagnosis.parts.fitting.chance import (
    blames_force,
    blames_forces,
    by_chance,
    by_what_is_left,
    deviance,
    differ,
    is_chance,
    without_chance,
)
from doormill_ros.diagnosis.parts.fitting.discrepancy import DISCREPANCIES, Discrepancy
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis, DoorProblem
from doormill_ros.statistics import bootstrap_ratio
from doormill_ros.units import m_to_um

#: Questions doors.
Ask = Callable[[DoorProblem, Progress], DoorDiagnosis]
#: Share of what named causes leave beyond noise that may be left beside a discrepancy, to ask beside it.
_MAIN = 0.5
_ROUNDS = 2  #: times that what forces by chance make is taken from what was found


def asked_beside(found: DoorDiagnosis, ask: Ask, progress: Progress) -> DoorDiagnosis:
    """What is said beside the fewest discrepancies that leave noise, where that is less or surer; else the same.

    Args:
        found: What is said of the doors without one.
        ask: Questions the doors.
        progress: Told of every step.
    """
    by_forces = _beside_chance(found, ask, progress)
    if _at_noise(by_forces) or by_forces.verdict not in (PARTLY_EXPLAINED, UNEXPLAINED):
        return by_forces
    problem = found.problem
    recurring = len(problem.doors) / len({door.recipe for door in problem.doors})
    for kind in DISCREPANCIES:
        discrepancy = kind(problem.off)
        beside = problem.beside(discrepancy)
        if recurring < discrepancy.recurring or not _is_main(beside, found):
            continue
        progress(f"asking beside what every door may show alike: {discrepancy.acts_on}")
        other = _beside_chance(ask(beside, progress), ask, progress)
        keys = {finding.cause.key for finding in other.findings}
        # What it could be itself is not given up for it; any other name was given beside more than noise.
        asked = [one for one in found.findings if discrepancy.could_be(one.cause.effect)]
        if other.question.at_noise(other.extended) and all(one.cause.key in keys for one in asked):
            return with_discrepancy(other)
    return by_forces


def _beside_chance(found: DoorDiagnosis, ask: Ask, progress: Progress) -> DoorDiagnosis:
    """What is said where forces are other ones at every door, if that is as likely; else the same."""
    blamed = blames_forces(found)
    if _at_noise(found) and not blamed:
        return found
    chance = by_chance(found.problem)
    if chance is None:
        return found
    beside = found.problem.beside(*found.problem.discrepancies, chance)
    if not blamed and not _is_main(beside, found):
        return found
    progress("asking beside forces that are other ones at every door")
    other = ask(beside, progress)
    for _ in range(_ROUNDS if other.question.at_noise(other.best) else 0):
        again = by_what_is_left(other)
        if again is None or not differ(other.problem, again, chance):
            break
        progress("asking once more: forces by chance make another difference than it seemed")
        chance, beside = again, other.problem.beside(*without_chance(other), again)
        other = min(other, ask(beside, progress), key=deviance)
    if not is_chance(found, other):
        return found
    if other.question.at_noise(other.best):
        return with_discrepancy(other)
    # What stands beside more than noise is not said anew; what chance says as well is taken back.
    said = {finding.cause.key for finding in other.findings}
    doubtful = [
        finding.cause
        for finding in found.findings
        if blames_force(finding.cause) and finding.cause.key not in said
    ]
    return found.less(doubtful, "forces that are other ones at every door say as much") if doubtful else found


def _is_main(beside: DoorProblem, found: DoorDiagnosis) -> bool:
    """Whether most of what named causes leave beyond noise could be a discrepancy."""
    members, theta = found.extended.members, found.extended.theta
    return beside.excess(members, theta) <= _MAIN * found.problem.excess(members, theta)


def _at_noise(found: DoorDiagnosis) -> bool:
    return all(member.named for member in found.best.members) and found.question.at_noise(found.best)


def with_discrepancy(found: DoorDiagnosis) -> DoorDiagnosis:
    """The same with figures and verdict of the doors without their discrepancy: a law without a name is no name."""
    plain, kept, question = found.problem.beside(), found.kept, found.question
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


def unnamed_document(diagnosis: DoorDiagnosis, laws: Sequence[str]) -> dict[str, Any]:
    """`unnamed` and `characterised` of diagnosis.json, with `laws_of`; nothing where there are none."""
    discrepancies, kept = diagnosis.problem.discrepancies, diagnosis.kept
    if not discrepancies:
        return {}
    squares = diagnosis.question.holdout_squares(diagnosis.extended, kept)
    _, (low, high) = bootstrap_ratio(np.full(len(squares), squares.mean()), squares)
    value = diagnosis.question.holdout_rmse(diagnosis.extended, kept)
    unnamed = [
        {
            "where": discrepancy.where,
            "acts_on": discrepancy.acts_on,
            "driver": discrepancy.driver,
            "law": law,
            "holdout_rmse_without": diagnosis.holdout_rmse[1],
            "rivals": [],
            "test": discrepancy.test,
        }
        for discrepancy, law in zip(discrepancies, laws, strict=True)
    ]
    return {"unnamed": unnamed, "characterised": {"holdout_rmse": value, "ci95": [value * low, value * high]}}


def unnamed_sentences(diagnosis: DoorDiagnosis, laws: Sequence[str]) -> list[str]:
    """What of it the report says, with `laws_of`."""
    discrepancies = diagnosis.problem.discrepancies
    if not discrepancies:
        return []
    left = diagnosis.question.holdout_rmse(diagnosis.extended, diagnosis.kept)
    told = " Also without a name: ".join(f"{law}." for law in laws)
    return [
        f"Without a name: {told} Beside that the doors leave {m_to_um(left):.1f} um. "
        + " ".join(one.hides for one in discrepancies),
        *(f"What it is: {one.test}." for one in discrepancies),
    ]


def laws_of(diagnosis: DoorDiagnosis) -> list[str]:
    """Every discrepancy beside which the doors were asked, in words."""
    return [_law(diagnosis, one) for one in diagnosis.problem.discrepancies]


def _law(diagnosis: DoorDiagnosis, discrepancy: Discrepancy) -> str:
    """A discrepancy in words, with what the doors leave more without it."""
    problem, extended = diagnosis.problem, diagnosis.extended
    others = problem.beside(*(one for one in problem.discrepancies if one is not discrepancy))
    more, less = (
        rmse(one.predict(extended.members, extended.theta).residual, diagnosis.kept, problem.components)
        for one in (others, problem)
    )
    return f"{discrepancy.words}, by {m_to_um(np.sqrt(max(more**2 - less**2, 0.0))):.0f} um root mean square"
