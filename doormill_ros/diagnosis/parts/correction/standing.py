"""What doors told of where the tool stands without load, as a correction of the path undoes it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.examining.finding import Finding
from doormill_ros.diagnosis.parts.correction.level import Level, level_beside
from doormill_ros.diagnosis.parts.correction.warming import warmed
from doormill_ros.diagnosis.parts.effects.case import TOOL
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis
from doormill_ros.robot_model.displacement import Displacement

CAMERA, CLAMP = ("camera_shift", "camera"), ("clamp_shift", "clamp")
WEIGHT = ("gravity_sag", TOOL)


def undone(finding: Finding[InTime]) -> bool:
    """Whether moving the path undoes it."""
    return finding.cause.key in (CAMERA, CLAMP, WEIGHT)


def standing_of(diagnosis: DoorDiagnosis) -> Displacement | None:
    """As it was at the last door; None where the tool stands where it was sent.

    With the level of what is left beside the names that a correction undoes: doors that stand elsewhere, by whatever
    cause, are milled where they stand.
    """
    found = {finding.cause.key: finding for finding in diagnosis.findings if undone(finding)}
    level = level_left(diagnosis)
    if not found and level is None:
        return None
    shift, turn, variance = np.zeros(3), 0.0, 0.0
    if (camera := found.get(CAMERA)) is not None:
        turn = float(camera.values[2])
        seen = np.array([0.0, *camera.values[:2]])
        shift = shift + seen - np.cross([turn, 0.0, 0.0], _eye(diagnosis))
        variance += float(np.sum(camera.std[:2] ** 2))
    if (clamp := found.get(CLAMP)) is not None:
        shift = shift + clamp.values[:3]
        variance += float(np.sum(clamp.std[:3] ** 2))
    if level is not None:
        turned = np.array([level.place[2], 0.0, 0.0])
        shift = shift + np.array([0.0, *level.place[:2]]) - np.cross(turned, level.corner)
        turn += float(level.place[2])
        variance += level.std(diagnosis.problem.points.point) ** 2
    mass, mass_std, centre = 0.0, 0.0, 0.0
    if (weight := found.get(WEIGHT)) is not None:
        mass, centre = (float(value) for value in weight.values[:2])
        mass_std = float(weight.std[0])
    return Displacement(tuple(map(float, shift)), turn, float(np.sqrt(variance)), mass, mass_std, centre)


@lru_cache(maxsize=1)  # wanted by the model, by what it would change, and by the report
def level_left(diagnosis: DoorDiagnosis) -> Level | None:
    """Where doors stand beside what the names say that a correction undoes; None where chance puts them there, too.

    What displaces the tool as a whole and no correction undoes by name, a link say, is a part of it.
    """
    model = diagnosis.extended
    left = [
        finding.cause.identity
        for finding in diagnosis.findings
        if finding.cause.effect.rigid and not undone(finding) and not warmed(finding)
    ]
    members = [member for member in model.members if member.identity not in left]
    theta = np.concatenate([np.zeros(0), *(model.theta[model.part(member)] for member in members)])
    found = level_beside(diagnosis.problem, members, theta)
    return found if found is not None and found.seen else None


def _eye(diagnosis: DoorDiagnosis) -> FloatArray:
    """About what a camera turns, in the mean of the doors, shape (3,) [m]."""
    mean: FloatArray = np.mean([door.eye for door in diagnosis.problem.doors], axis=0)
    return mean
