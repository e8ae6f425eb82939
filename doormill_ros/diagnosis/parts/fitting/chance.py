"""Forces that are other ones at every door, as wood is: whether that says what changes from door to door were told of.

A few doors of forces by chance look as if they had changed here and drifted there. Which of the two it is, the
likelihood of the doors says, places, mill and forces integrated out, less what numbers and doors to choose from cost.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.searching.beam import EQUAL
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.discrepancy import Discrepancy, ForceDiscrepancy, gives_way
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis, DoorProblem

_FREE = 2  #: doors beyond what their forces are described by
_OTHER = 0.2  #: share by which what forces by chance make differs until it matters
_MOST = 1.0  #: share of itself by which a force may scatter
_SEEN_SCATTER = 4.0  #: fall of -2 log likelihood from which on forces scatter at all: two standard deviations
_SEEN = 1e-9  #: share of the best seen door's force below which that of another is not seen


def blames_forces(found: DoorDiagnosis) -> bool:
    """Whether something is said to change from door to door that another force at every door might be taken for."""
    return any(blames_force(member) for member in found.best.members)


def blames_force(member: InTime) -> bool:
    """The same of one member of a model."""
    return (member.course.steps or member.course.drifts) and not member.effect.rigid


def by_chance(problem: DoorProblem) -> ForceDiscrepancy | None:
    """Forces that differ by chance as much as those of doors of one recipe do; None where they do not.

    Of doors that are nearly all other ones, as much as all of them do.
    """
    if len(problem.doors) <= _FREE:
        return None
    shares, variance = force_shares(problem)
    recipes = np.unique([door.recipe for door in problem.doors], return_inverse=True)[1].ravel()
    if len(shares) - recipes.max() - 1 < _FREE:
        recipes = np.zeros(len(shares), dtype=int)
    return _scattering(problem, shares, variance, recipes)


def by_what_is_left(found: DoorDiagnosis) -> ForceDiscrepancy | None:
    """The same by what an answer leaves, whose forces are right but for chance, and as its causes give way.

    Of a best model with shapes that have no name the best one without them is taken, if it is as good.
    """
    problem, model = found.problem.beside(*without_chance(found)), _named(found)
    chance = _scattering(problem, *force_shares(problem, model.members, model.theta), None)
    return chance and replace(chance, members=model.members, theta=tuple(model.theta.tolist()))


def _named(found: DoorDiagnosis) -> Fit[InTime]:
    search, limit = found.search, found.search.total(found.best) + EQUAL
    named = [fit for fit in search.fits.values() if all(member.named for member in fit.members)]
    good = [fit for fit in named if search.total(fit) < limit and found.question.at_noise(fit)]
    return search.ranked(good)[0] if good else search.fit(())


def without_chance(found: DoorDiagnosis) -> list[Discrepancy]:
    """Discrepancies beside which an answer was given, less that of forces."""
    return [one for one in found.problem.discrepancies if not isinstance(one, ForceDiscrepancy)]


def differ(problem: DoorProblem, one: ForceDiscrepancy, other: ForceDiscrepancy) -> bool:
    """Whether what forces by chance make of the points is so different that doors have to be asked once more."""
    a, b = (found.columns(problem.case) for found in (one, other))
    return float(np.linalg.norm(a - b)) > _OTHER * float(np.linalg.norm(b))


def _scattering(
    problem: DoorProblem, shares: FloatArray, variance: FloatArray, groups: IntArray | None
) -> ForceDiscrepancy | None:
    """By restricted likelihood of shares, shape (d,), about the mean of their groups; of no groups about zero."""

    def of_scatter(scatter: float) -> float:
        weight = 1.0 / (variance + scatter**2)
        away, numbers = shares, 0.0
        if groups is not None:
            each = np.bincount(groups, weight)
            away = shares - (np.bincount(groups, weight * shares) / each)[groups]
            numbers = float(np.sum(np.log(each)))
        return float(np.sum(weight * away**2) - np.sum(np.log(weight))) + numbers

    found = minimize_scalar(of_scatter, bounds=(0.0, _MOST), method="bounded")
    if of_scatter(0.0) - found.fun < _SEEN_SCATTER:
        return None
    springs = problem.case.springs()
    return ForceDiscrepancy(float(found.x * np.sqrt(np.mean(springs**2))))


def force_shares(
    problem: DoorProblem, members: Sequence[InTime] = (), theta: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """By what share of itself the force of each door is larger than in a model, and the variance of that.

    Args:
        problem: The doors.
        members: Of the model.
        theta: Its numbers, shape (p,); None for none.

    Returns:
        Two arrays of shape (d,).
    """
    theta = np.zeros(0) if theta is None else theta
    given = gives_way(problem.case, members, theta) / problem.noise
    columns = problem.nuisance.take(given[:, None] * (problem.door[:, None] == np.arange(len(problem.doors))))
    left = problem.predict(members, theta).white[:, 0]
    square = columns.T @ columns
    seen = np.diag(square)
    inverse = np.linalg.inv(square + np.diag(np.full(len(seen), _SEEN * seen.max())))
    return inverse @ (columns.T @ left), np.diag(inverse)


def is_chance(without: DoorDiagnosis, beside: DoorDiagnosis) -> bool:
    """Whether forces by chance say of the doors what names say without them, or something as likely.

    Other names have to be likelier by more than models differ by that count as equally good.
    """
    same = {one.cause.identity for one in without.findings} == {one.cause.identity for one in beside.findings}
    gain = deviance(beside) - deviance(without)
    return gain < (0.0 if same else EQUAL)


def deviance(found: DoorDiagnosis) -> float:
    """-2 log likelihood of the best model, less a constant, with what numbers and doors of change cost (BIC)."""
    problem, model = found.problem, found.best
    each, steps = np.log(len(problem)), sum(member.course.steps for member in model.members)
    numbers = model.size + len(problem.discrepancies)
    chosen = 2.0 * np.log(max(len(problem.doors) - 1, 1)) * steps
    return float(model.score + problem.nuisance.log_determinant + each * numbers + chosen)
