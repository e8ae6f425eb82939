"""The model that a diagnosis of doors leaves for the path generator: what a correction undoes, and how well known."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.examining.finding import Finding
from doormill_ros.diagnosis.core.fitting.fit import fit
from doormill_ros.diagnosis.core.words.verdict import UNEXPLAINED
from doormill_ros.diagnosis.parts.correction.standing import standing_of, undone
from doormill_ros.diagnosis.parts.correction.warming import growth_told, warmed
from doormill_ros.diagnosis.parts.effects.case import TOOL
from doormill_ros.diagnosis.parts.effects.force import ForceScale, ForceTurn
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.moved import moved
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis
from doormill_ros.diagnosis.parts.telling.next_door import PLACES
from doormill_ros.robot_model.elastic.causes.registry import build_cause
from doormill_ros.robot_model.elastic.knowledge import MeasuredForce
from doormill_ros.robot_model.extended_document import model_document
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel, SizedCause
from doormill_ros.statistics import root_mean_square


def usable(diagnosis: DoorDiagnosis) -> tuple[list[SizedCause], list[str]]:
    """Causes that bend the robot, as they will be at the next door, and what no correction undoes, in words.

    One that another would explain as well keeps no standard deviation: which of them it is, is the larger doubt.
    """
    found, others = [], []
    for finding in diagnosis.findings:
        cause = finding.cause
        variant = cause.effect.variant if cause.name != "joint_backlash" else ""
        try:
            known = build_cause(cause.name, cause.where, variant)
        except KeyError:
            if undone(finding) or warmed(finding):
                continue
            others.append(f"{cause.name} at {cause.where}")
            continue
        size = sum(parameter.size for parameter in known.parameters)
        std = None if finding.confusable else np.array(finding.std[:size])
        found.append(SizedCause(known, _at_next_door(diagnosis, finding)[:size], std))
    return found, others


def _at_next_door(diagnosis: DoorDiagnosis, finding: Finding[InTime]) -> FloatArray:
    """Parameters in a row: those of the last doors, and of a drift what one door more makes of them."""
    cause, doors = finding.cause, diagnosis.problem.doors
    course = cause.course
    if not course.drifts:
        return np.array(finding.values)
    theta = diagnosis.extended.theta[diagnosis.extended.part(cause)].reshape(course.sizes, -1)
    next_time = course.end + (course.end - course.begin) / (len(doors) - 1)
    next_theta = course.size(theta, np.array([next_time]))[0]
    low, high = cause.effect.lower, cause.effect.upper
    return cause.effect.values(np.clip(next_theta, low, high), diagnosis.problem.case)


def measured_force(diagnosis: DoorDiagnosis) -> MeasuredForce | None:
    """How well the doors tell the process force; None where they do not.

    They do not where something is left that no name explains. Size and direction about the tool go together: of one
    that is not named, the spread is what a fit leaves to it and what it finds. Where something else would do as well as
    a force, `_doubt` adds to that of the size. Doors that come out as assumed have measured the force, too.
    """
    if diagnosis.verdict == UNEXPLAINED:
        return None
    doubt = _doubt(diagnosis)
    if doubt is None:
        return None
    problem, best = diagnosis.problem, diagnosis.examination.best
    named = {finding.cause.name: finding for finding in diagnosis.findings if finding.cause.where == TOOL}
    spreads = []
    for effect in (ForceScale(TOOL), ForceTurn(TOOL)):
        if effect.name in named:
            spreads.append(float(named[effect.name].std[0]))
            continue
        beside = InTime(effect)
        found = fit(problem, [*best.members, beside], [np.append(best.theta, 0.0)])
        noise = max(1.0, float(np.mean(best.prediction.cost[best.weights > 0.0])) / problem.components)
        variance = noise * found.covariance[-1, -1] + found.theta[-1] ** 2
        spreads.append(float(np.sqrt(variance)))
    loaded = np.linalg.norm(problem.case.load.force, axis=1) > 0.0
    kinds = tuple(str(kind) for kind in np.unique(problem.points.kind[loaded]))
    return MeasuredForce(kinds, float(np.hypot(spreads[0], doubt)), spreads[1])


def _doubt(diagnosis: DoorDiagnosis) -> float | None:
    """Share of the force that is in doubt where something else would do as well; None where nobody knows how much.

    Which of them it is, the next doors do not ask. What counts is how differently the models move points wherever the
    tool cut, as they do since the last change; in few places, where that says little of others, how different a force
    they have.
    """
    problem, best = diagnosis.problem, diagnosis.examination.best
    others = [
        equal.model
        for finding in diagnosis.findings
        for equal in finding.equals
        if {finding.cause.name, equal.cause.name} & {ForceScale.name, ForceTurn.name}
    ]
    displaced, loaded = moved(problem.case, best.members, best.theta)
    doubt = 0.0
    for model in others:
        if model is None:
            return None
        steps = [member.course.at for member in (*best.members, *model.members) if member.course.steps]
        since = problem.case.time >= max(steps, default=-np.inf)
        displaced_so, loaded_so = moved(problem.case, model.members, model.theta)
        apart, size = displaced_so - displaced, problem.case.springs()
        if problem.places < PLACES:
            apart, size = loaded_so.load.force - loaded.load.force, problem.case.load.force
        doubt = max(doubt, root_mean_square(apart[since]) / root_mean_square(size[since]))
    return doubt


@lru_cache(maxsize=1)  # fits of the force, wanted by the model and by what it would change
def door_model(diagnosis: DoorDiagnosis) -> ExtendedComplianceModel:
    """The model that corrects the next doors, in the cold and without where its tool stands."""
    robot = diagnosis.problem.robot
    return ExtendedComplianceModel(
        robot.name,
        robot.dh,
        robot.stiffness,
        usable(diagnosis)[0],
        force=measured_force(diagnosis),
        place=standing_of(diagnosis),
        growth=growth_told(diagnosis),
    )


def door_model_document(diagnosis: DoorDiagnosis, source: str) -> dict[str, Any]:
    """The content of model.yaml."""
    model = door_model(diagnosis)
    return model_document(
        model.robot,
        model.joint_stiffness,
        model.causes,
        f"diagnosis of {source}, verdict {diagnosis.verdict}",
        force=model.force,
        standing=model.place,
        growth=model.growth,
    )
