"""What follows a verdict that leaves something: where it acts, what drives it, and a law that predicts unseen postures.

The terms of a dictionary, and causes that were not believed, join the established causes one by one. Whole postures
are left out, predicted and compared; a term enters only if that score falls by what chance does not make it. No law
is a cause: the verdict stays.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from doormill_ros.diagnosis.core.beam import EQUAL
from doormill_ros.diagnosis.core.characterised import Characterised, Rival, UnnamedLaw
from doormill_ros.diagnosis.core.diagnosis import Diagnosis, P
from doormill_ros.diagnosis.core.fit import Fit
from doormill_ros.diagnosis.core.verdict import PARTLY_EXPLAINED, UNEXPLAINED, rmse
from doormill_ros.diagnosis.law.place import acts_on, place_of
from doormill_ros.diagnosis.law.search import LawSearch
from doormill_ros.diagnosis.law.telling import law_in_words, test_of
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.statistics import resampled

_DRAWS = 4000  #: of configurations, for the interval
_RIVALS = 4  #: that are told, at most


def characterise(
    diagnosis: Diagnosis[P, ElasticCause],
    terms: Sequence[ElasticCause],
    progress: Callable[[str], None] = lambda line: None,
) -> Characterised[ElasticCause] | None:
    """Laws for what a diagnosis leaves; None where it leaves nothing or nothing can be said.

    Args:
        diagnosis: With its verdict.
        terms: That may enter.
        progress: Told of every step.
    """
    if diagnosis.verdict not in (UNEXPLAINED, PARTLY_EXPLAINED):
        return None
    problem, extended = diagnosis.problem, diagnosis.extended
    keys = {cause.key for cause in extended.members}
    search = LawSearch(
        problem, extended.members, extended.theta, [t for t in terms if t.key not in keys], progress
    )
    best = search.run()
    if not search.laws(best):
        return None
    kept = diagnosis.kept
    residual = rmse(best.held_out, kept, problem.components)
    squares = np.array(
        [
            (np.sum(best.held_out[rows] ** 2), problem.components * rows.sum())
            for c in np.unique(problem.configuration[kept])
            for rows in [kept & (problem.configuration == c)]
        ]
    )
    drawn = squares[resampled(len(squares), _DRAWS)].sum(axis=1)
    low, high = np.quantile(np.sqrt(drawn[:, 0] / drawn[:, 1]), [0.025, 0.975])
    laws = sorted(_laws(diagnosis, search, best), key=lambda law: -round(law.without / residual, 6))
    return Characterised(best, laws, residual, (float(low), float(high)))


def _laws(
    diagnosis: Diagnosis[P, ElasticCause], search: LawSearch, best: Fit[ElasticCause]
) -> list[UnnamedLaw[ElasticCause]]:
    problem = diagnosis.problem
    places: dict[tuple[str, str], list[ElasticCause]] = {}
    for term in search.laws(best):
        places.setdefault(place_of(term), []).append(term)
    found = []
    for (where, driver), terms in places.items():
        rest = search.without(best, *terms)
        weights = [term.values(best.theta[best.part(term)], problem.case) for term in terms]
        found.append(
            UnnamedLaw(
                where=where,
                acts_on=acts_on(terms[0]),
                driver=driver,
                law="; ".join(law_in_words(term, own) for term, own in zip(terms, weights, strict=True)),
                terms=tuple(terms),
                without=rmse(rest.held_out, diagnosis.kept, problem.components),
                rivals=_rivals(search, best, terms),
                test=test_of(driver),
            )
        )
    return found


def _rivals(
    search: LawSearch, best: Fit[ElasticCause], terms: Sequence[ElasticCause]
) -> tuple[Rival[ElasticCause], ...]:
    """Other places and drivers in the place of a law's only term that would do nearly as well."""
    if len(terms) > 1:
        return ()
    own, listed = place_of(terms[0]), {}
    for other, found in search.rivals(best, terms[0]):
        behind = search.total(found) - search.total(best)
        place = place_of(other)
        if place != own and behind < EQUAL and place not in listed:
            listed[place] = Rival(other, *place, round(behind, 3))
    return tuple(listed.values())[:_RIVALS]
