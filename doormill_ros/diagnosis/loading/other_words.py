"""What acts elsewhere and yet does what a cause does: a base that turns about joint 1 is the spring of that joint."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.loading.law_place import place_of
from doormill_ros.diagnosis.loading.problem import LoadingProblem
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause

_NOTHING = 1e-6  #: share of an effect that is rounding


def acts(term: ElasticCause) -> tuple[str, str]:
    """Where a term acts and on what, whatever drives it."""
    place = place_of(term)
    return place.where, place.acts_on


def in_other_words(
    problem: LoadingProblem, told_by: Fit[ElasticCause], cause: ElasticCause, terms: Sequence[ElasticCause]
) -> list[ElasticCause]:
    """Terms that do in every trial what a member of a model does, with all that varies the same thing of the robot.

    What two things of the measuring chain have in common hangs on the trials: varied they are two.
    """
    effect = (problem.predict(*less(told_by, cause)).white - told_by.prediction.white).ravel()
    same = [term for term in terms if _followed(problem, term, effect) >= 1.0 - _NOTHING]
    varied = {acts(term) for term in same} if cause.of_robot else set()
    return [term for term in terms if term in same or acts(term) in varied]


def less(model: Fit[ElasticCause], cause: ElasticCause) -> tuple[tuple[ElasticCause, ...], FloatArray]:
    """The other members of a model, and their parameters as they are, shape (p,)."""
    rest = tuple(other for other in model.members if other is not cause)
    return rest, np.concatenate([np.zeros(0), *(model.theta[model.part(other)] for other in rest)])


def _followed(problem: LoadingProblem, term: ElasticCause, effect: FloatArray) -> float:
    """Share of an effect, shape (3 n,), that a term follows."""
    basis, _ = np.linalg.qr(problem.slope(term, np.zeros(term.size)).reshape(len(effect), -1))
    return float(np.sum((basis.T @ effect) ** 2) / max(float(effect @ effect), 1e-300))
