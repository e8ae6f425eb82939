"""Which other causes would do as well as a named one."""

from __future__ import annotations

from itertools import islice

import numpy as np

from doormill_ros.diagnosis.core.examining.examination import Double
from doormill_ros.diagnosis.core.examining.stability import beaten
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.fitting.kinks import score_without
from doormill_ros.diagnosis.core.fitting.problem import C
from doormill_ros.diagnosis.core.fitting.ranking import QUANTUM
from doormill_ros.diagnosis.core.searching.beam import EQUAL, BeamSearch
from doormill_ros.statistics import root_mean_square

#: Fall of the score with one more number that chance reaches once in ten sets.
LEANING = 2.7
_NEAR = 40.0  #: score within which a model is worth another look at its kinked numbers
_DIFFERS = 0.1  #: share of the resolution from which on two models differ at a trial
_TRIED = 6  #: pairs of causes that are fitted in place of one


def equals(
    search: BeamSearch[C], best: Fit[C], cause: C, structure: bool, resolution: float = 0.0
) -> list[Double[C, Fit[C]]]:
    """Causes that do as well in the place of one member; the best first.

    Args:
        search: All models.
        best: The best of them.
        cause: One of its members.
        structure: Whether something remains unexplained; small differences then mean little.
        resolution: Root mean square of residuals by which two models have to differ [unit of the problem].
    """
    good = best.weights > 0.0
    remains = structure or not all(member.named for member in best.members)
    excess = float(np.mean(best.prediction.cost[good])) / search.problem.components
    limit = EQUAL * max(3.0, excess) if remains else EQUAL
    found: dict[tuple[str, str], tuple[C, Fit[C]]] = {}
    for other, model in search.rivals(best, cause):
        nested = other.where == cause.where and cause.name in (other.generalises, other.name)
        if nested and other.name != cause.name:
            # A law that contains this one counts as another only if the data lean towards it, or if
            # what it adds can stand for all of this one.
            leans = model.score < best.score - LEANING
            nested = not (leans or _instead(search, best, model, other))
        if other.named and model.held_out_score < best.held_out_score + limit + _NEAR:
            model = search.polished(model)
        close = model.held_out_score < best.held_out_score + limit or _alike(best, model, resolution)
        as_good = close or (remains and not beaten(search.problem, best, model))
        if other.named and other.key != cause.key and not nested and as_good:
            found.setdefault(other.key, (other, model))
    for model in _pairs_with_fewer_numbers(search, best, cause):
        for other in model.members:
            if all(other is not member for member in best.members):
                found.setdefault(other.key, (other, model))
    total = search.total(best)
    return [_double(other, model, search.total(model) - total) for other, model in found.values()]


def _alike(best: Fit[C], model: Fit[C], resolution: float) -> bool:
    """Whether two models predict the same, as far as the data are good for, where they differ at all."""
    if resolution == 0.0:
        return False
    apart = np.linalg.norm(model.prediction.residual - best.prediction.residual, axis=1)
    apart = apart[apart > _DIFFERS * resolution]
    return not len(apart) or root_mean_square(apart) < resolution


def _double(cause: C, model: Fit[C], behind: float) -> Double[C, Fit[C]]:
    tied = abs(behind) <= QUANTUM  # told in whole quanta: less than that is not told apart
    return Double(cause, QUANTUM * round(behind / QUANTUM) if tied else behind, tied, model)


def _instead(search: BeamSearch[C], best: Fit[C], model: Fit[C], other: C) -> bool:
    """Whether a law fits as well without its first number, which it shares with the law it contains."""
    part = model.part(other)
    starts = []
    for start in other.starts(search.problem.case):
        theta = model.theta.copy()
        theta[part] = start
        starts.append(theta)
    return score_without(search.problem, model.members, starts, part.start) < best.score + EQUAL


def _pairs_with_fewer_numbers(search: BeamSearch[C], best: Fit[C], cause: C) -> list[Fit[C]]:
    """Models in which two causes of one number each stand for one of three numbers, and fit as well.

    One cause is simpler than two, yet three numbers are more than two: nothing then speaks for either.
    """
    if cause.size < 3:
        return []
    rest = search.without(best, cause)
    smaller = (
        (one, two)
        for one, two in search.promising(rest, best)
        if one.named and two.named and one.size + two.size < cause.size
    )
    models = [search.add(search.add(rest, one), two) for one, two in islice(smaller, _TRIED)]
    return [model for model in models if search.total(model) < search.total(best)]
