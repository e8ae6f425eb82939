"""What began, changed or drifts over doors, and since which of them; for problems that have `doors`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.course import OverTime
from doormill_ros.diagnosis.core.diagnosis import Diagnosis, diagnose_problem
from doormill_ros.diagnosis.core.fitting.fit import fit

STEP, DRIFT = "step", "drift"
_SURE = 0.95
_HOPELESS = 20.0  #: score behind the best step from which on doors further away are not asked
_FARTHEST = 12  #: doors from the step that are


@dataclass(frozen=True)
class Change:
    """One cause whose size is not the same for all doors.

    Attributes:
        what, where: Cause and place.
        kind: STEP or DRIFT.
        door: Number of the first door with the new size; of a drift, the first of all.
        between: First and last door with which it may have begun, 95 %.
        before, after: Parameters before the step and after it; of a drift, at the first and at the last door.
    """

    what: str
    where: str
    kind: str
    door: int
    between: tuple[int, int]
    before: Mapping[str, Any]
    after: Mapping[str, Any]


def diagnosed_at(
    problem: Any, steps: tuple[int, ...], progress: Callable[[str], None]
) -> Diagnosis[Any, Any]:
    """Diagnose a problem that has `doors`, with those from which on something may have changed."""
    problem = problem.changed_at(steps)
    if problem.steps:
        names = ", ".join(problem.doors[step].name for step in problem.steps)
        progress(f"something may have changed at {names}")
    return diagnose_problem(problem, progress)


def changes_of(diagnosis: Diagnosis[Any, Any]) -> list[Change]:
    """Every step and drift of a named cause, in the order of the doors."""
    found, times = [], [door.time for door in diagnosis.problem.doors]
    for finding in diagnosis.findings:
        cause = finding.cause
        course = cause.course
        theta = diagnosis.extended.theta[diagnosis.extended.part(cause)].reshape(course.sizes, -1)
        told = {suffix: _told(cause, diagnosis, part) for suffix, part in course.told(theta).items()}
        if course.steps:
            door = times.index(course.at)
            between = _between(diagnosis, cause, door)
            found.append(
                Change(cause.name, cause.where, STEP, door, between, told.get("before", {}), told[""])
            )
        if course.drifts or cause.effect.drifts:
            found.append(
                Change(cause.name, cause.where, DRIFT, 0, (0, 0), told.get("at_first", {}), told[""])
            )
    return sorted(found, key=lambda change: change.door)


def _told(cause: OverTime[Any], diagnosis: Diagnosis[Any, Any], theta: Any) -> dict[str, Any]:
    values = cause.effect.values(theta, diagnosis.problem.case)
    told, at = {}, 0
    for parameter in cause.effect.parameters:
        part = [float(value) for value in values[at : at + parameter.size]]
        told[parameter.name] = part[0] if parameter.size == 1 else part
        at += parameter.size
    return told


def _between(diagnosis: Diagnosis[Any, Any], cause: OverTime[Any], door: int) -> tuple[int, int]:
    """First and last door of the smallest range that holds the step with 95 %, all doors alike before the data."""
    problem, extended = diagnosis.problem, diagnosis.extended
    score = {door: extended.score}
    for way in (-1, 1):
        for number in range(door + way, door + way * (_FARTHEST + 1), way):
            if not 0 < number < len(problem.doors):
                break
            moved = type(cause)(cause.effect, replace(cause.course, at=problem.doors[number].time))
            members = [moved if member is cause else member for member in extended.members]
            score[number] = fit(problem, members, [extended.theta]).score
            if score[number] > extended.score + _HOPELESS:
                break
    numbers = sorted(score)
    chance = np.exp(-0.5 * (np.array([score[n] for n in numbers]) - min(score.values())))
    chance /= chance.sum()
    low = high = int(chance.argmax())
    while chance[low : high + 1].sum() < _SURE:
        left = chance[low - 1] if low > 0 else -1.0
        right = chance[high + 1] if high + 1 < len(numbers) else -1.0
        low, high = (low - 1, high) if left > right else (low, high + 1)
    return numbers[low], numbers[high]


def changes_document(diagnosis: Diagnosis[Any, Any], changes: Sequence[Change]) -> list[dict[str, Any]]:
    """As diagnosis.json has them."""
    doors = diagnosis.problem.doors
    return [
        {
            "what": change.what,
            "where": change.where,
            "kind": change.kind,
            "from_run": doors[change.door].run_id,
            "from_door": doors[change.door].name,
            "from_run_ci95": [doors[end].run_id for end in change.between],
            "from_door_ci95": [doors[end].name for end in change.between],
            "before": dict(change.before),
            "after": dict(change.after),
        }
        for change in changes
    ]


def change_sentences(diagnosis: Diagnosis[Any, Any], changes: Sequence[Change]) -> list[str]:
    """One a change."""
    doors, found = diagnosis.problem.doors, []
    for change in changes:
        words = f"{change.what.replace('_', ' ')} at {change.where}"
        if change.kind == DRIFT:
            found.append(f"{words} drifts from {doors[0].name} to {doors[-1].name}.")
            continue
        low, high = (doors[end].name for end in change.between)
        sure = f"95 %: {low}" if low == high else f"95 %: {low} to {high}"
        verb = "changed" if change.before else "began"
        found.append(f"{words} {verb} with {doors[change.door].name} ({sure}).")
    return found
