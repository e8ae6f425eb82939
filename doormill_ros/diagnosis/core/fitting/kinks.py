"""Numbers in which the cost has kinks, and those that may as well be zero."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.fit import Fit, descend, finish, fit
from doormill_ros.diagnosis.core.fitting.problem import C, Problem
from doormill_ros.diagnosis.core.fitting.ranking import QUANTUM, ranks
from doormill_ros.diagnosis.core.fitting.robust import robust_sum

_KINKS = 16  #: values at which a kinked number is tried
_NOTHING = 2.7  #: fall of the score below which a kinked number may as well be zero (one in ten)


def score_without(
    problem: Problem[C], members: Sequence[C], starts: Sequence[FloatArray], index: int
) -> float:
    """Score of a model in which one number stays at zero, the best from several starts.

    Args:
        problem: The set.
        members: Causes.
        starts: Each of shape (p,).
        index: The number that stays at zero.
    """
    scores = []
    for start in starts:
        theta = np.array(start, dtype=float)
        theta[index] = 0.0
        theta, _ = descend(problem, tuple(members), theta, fixed=index)
        scores.append(robust_sum(problem.predict(members, theta).cost))
    return min(scores)


def polish(problem: Problem[C], found: Fit[C]) -> Fit[C]:
    """Walk numbers with a kinked cost over all their kinks; a descent stops at the next one.

    A number that may as well be zero becomes zero: a gap is a step until the data say otherwise.
    The other numbers follow in two steps each.
    """
    for cause in found.members:
        for i in cause.kinked:
            index = found.part(cause).start + i
            size = cause.kinks(problem.case)
            values = np.unique(np.append(np.quantile(size, np.linspace(0.0, 1.0, _KINKS)), 0.0))
            tried = [(robust_sum(found.prediction.cost), found.theta)]
            for value in values:
                theta = found.theta.copy()
                theta[index] = value
                theta, _ = descend(problem, found.members, theta, steps=2, fixed=index)
                tried.append((robust_sum(problem.predict(found.members, theta).cost), theta))
            score, theta = tried[ranks(np.array([cost for cost, _ in tried]))[0]]
            at_zero = next(pair for pair in tried if pair[1][index] == 0.0 and pair is not tried[0])
            if at_zero[0] < score + _NOTHING:
                found = finish(problem, found.members, at_zero[1], found.weights, at_zero[0])
            elif theta is not found.theta:
                again = fit(problem, found.members, [theta])
                found = again if again.score < found.score - QUANTUM else found
    return found
