"""What to measure next: what tells confusable causes apart, and where doors have to stand for that."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from doormill_ros.diagnosis.core.examining.finding import Finding
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis
from doormill_ros.diagnosis.parts.telling.next_step import (
    CHECK,
    MORE_PLACES,
    NOTHING,
    POINTS,
    RECIPES,
    NextStep,
)
from doormill_ros.robot_model.candidate import Cause

PLACES = 3  #: in which doors have to be milled to tell the joints apart
DECIDED = 9.2  #: squared distance of two models at which they are told apart 100 to 1


def next_steps(diagnosis: DoorDiagnosis) -> list[NextStep]:
    """What to do next, the most telling first."""
    steps = [_between(diagnosis, finding) for finding in diagnosis.findings if finding.confusable]
    if steps:
        return list(dict.fromkeys(steps))
    if diagnosis.problem.places < PLACES:
        return [NextStep(MORE_PLACES)]
    if not diagnosis.findings and diagnosis.verdict == "consistent":
        return [NextStep(NOTHING)]
    return [NextStep(RECIPES)]


def checks_of(candidates: Iterable[Cause]) -> dict[str, str]:
    """What shows a cause without another door, by its name, of those of which that is known."""
    return {cause.name: cause.check for cause in candidates if cause.check}


def _between(diagnosis: DoorDiagnosis, finding: Finding[InTime]) -> NextStep:
    """The feature that tells a cause from the first of its doubles, or what else does."""
    problem, double = diagnosis.problem, finding.equals[0]
    # Where the effects alone were compared the double has no model of its own.
    other = double.model or diagnosis.best
    apart = (other.prediction.white - diagnosis.best.prediction.white)[:, 0] ** 2
    recipes = np.array([door.recipe for door in problem.doors])[problem.door]
    features = problem.points.feature
    each = {
        (str(feature), str(recipe)): float(apart[(features == feature) & (recipes == recipe)].mean())
        for feature, recipe in sorted(set(zip(features.tolist(), recipes.tolist(), strict=True)))
    }
    best = max(each, key=lambda label: each[label])
    pair = finding.cause.name, double.cause.name
    needed = DECIDED / max(each[best], 1e-12)
    if needed < 2000.0:
        return NextStep(POINTS, *pair, points=round(needed), feature=best[0], recipe=best[1])
    checks = checks_of(problem.effects())
    return NextStep(CHECK, *pair, by=next((name for name in pair if name in checks), ""))
