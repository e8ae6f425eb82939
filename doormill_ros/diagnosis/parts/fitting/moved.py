"""What a model moves the points by: process and weight together load the joints, everything else acts on that."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.problem import split
from doormill_ros.diagnosis.parts.effects.case import CutCase
from doormill_ros.diagnosis.parts.effects.effect import Unloaded
from doormill_ros.diagnosis.parts.effects.elastic import Gap
from doormill_ros.diagnosis.parts.fitting.course import InTime

_STEP = 1e-4  #: of theta, to derive what a load does

#: Members of a model, each with its part of theta.
_Parts = Sequence[tuple[InTime, FloatArray]]


def moved(case: CutCase, members: Sequence[InTime], theta: FloatArray) -> tuple[FloatArray, CutCase]:
    """What a model moves n points along their normals, shape (n,) [m], and the loads that it has.

    Args:
        case: The points under the loads that were assumed.
        members: Of the model.
        theta: Its numbers, shape (p,).
    """
    parts = split(members, theta)
    loaded = _felt(case, parts)
    hanging = _hanging(case, parts)
    if hanging is not None:
        loaded = loaded.carrying(hanging)
    found = loaded.springs()
    for member, part in parts:
        if not member.effect.of_load:
            found = found + np.sum(member.effect.columns(loaded) * member.rows(part, case.time), axis=1)
    return found, loaded


def by_load(case: CutCase, members: Sequence[InTime], theta: FloatArray, numbers: IntArray) -> FloatArray:
    """Derivative of that by numbers of theta that change loads, shape (n, k) [m].

    Which flank a joint lies against changes nowhere or all at once: gaps have no part in it, nor has what moves the
    points whatever the joints carry.
    """

    def by_what_changes(theta: FloatArray) -> FloatArray:
        parts = [part for part in split(members, theta) if not isinstance(part[0].effect, (Gap, Unloaded))]
        smooth = [member for member, _ in parts]
        return moved(case, smooth, np.concatenate([np.zeros(0), *(part for _, part in parts)]))[0]

    found = np.empty((len(case), len(numbers)))
    if not len(numbers):
        return found
    here = by_what_changes(theta)
    for column, i in enumerate(numbers):
        other = theta.copy()
        other[i] += _STEP
        found[:, column] = (by_what_changes(other) - here) / _STEP
    return found


def _felt(case: CutCase, parts: _Parts) -> CutCase:
    """Under the process as a model has it."""
    forces = [(member, part) for member, part in parts if member.effect.of_force]
    if not forces:
        return case
    gain, angle = np.ones(len(case)), np.zeros(len(case))
    for member, part in forces:
        factor, turn = member.effect.wrench(case, member.rows(part, case.time))
        gain, angle = gain * factor, angle + turn
    return case.felt(gain, angle)


def _hanging(case: CutCase, parts: _Parts) -> FloatArray | None:
    """Torque about each joint by the weights of a model, shape (n, 6) [N m]; None for none."""
    weights = [
        np.einsum("nkp,np->nk", member.effect.torques(case), member.rows(part, case.time))
        for member, part in parts
        if member.effect.of_weight
    ]
    return np.sum(weights, axis=0) if weights else None
