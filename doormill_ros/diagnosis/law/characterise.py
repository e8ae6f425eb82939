"""What follows a verdict that leaves something: where it acts, what drives it, and a law that predicts unseen postures.

The terms of a dictionary, and causes that were not believed, join the established causes one by one. Whole postures
are left out, predicted and compared; a term enters only if that score falls by what chance does not make it. No law
is a cause: the verdict stays.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.fitting.problem import C
from doormill_ros.diagnosis.core.searching.beam import EQUAL
from doormill_ros.diagnosis.core.telling.characterised import Characterised, Rival, UnnamedLaw
from doormill_ros.diagnosis.core.words.verdict import PARTLY_EXPLAINED, UNEXPLAINED, rmse
from doormill_ros.diagnosis.law.place import Places
from doormill_ros.diagnosis.law.repeated import Repeated
from doormill_ros.diagnosis.law.search import LawSearch
from doormill_ros.diagnosis.law.telling import law_in_words, test_of
from doormill_ros.statistics import resampled

_DRAWS = 4000  #: of configurations, for the interval
_RIVALS = 4  #: that are told, at most
_NO_BETTER = (
    "Of what remains nothing is said: laws that fit it were found, but when the search was repeated without some "
    "postures, what it found, many laws or few, predicted these no better than the named causes alone."
)


def remains(verdict: str) -> bool:
    """Whether a verdict leaves something to characterise."""
    return verdict in (UNEXPLAINED, PARTLY_EXPLAINED)


def characterise(search: LawSearch[C], kept: BoolArray) -> tuple[Characterised[C] | None, str]:
    """Laws for what a diagnosis leaves, or None; and why none is told where some were found, else nothing.

    Args:
        search: Over the terms that may enter, ready to run.
        kept: Rows that count, shape (n,).
    """
    best = search.run()
    if not search.laws(best):
        return None, ""
    search.progress("searching for laws again without some postures")
    repeated, most = Repeated(search, kept), search.most
    while (held_out := repeated.unseen_residual(most)) is None:
        # The last of several laws may be one that only a few postures speak for.
        most = len(search.laws(best)) - 1
        best = search.at_most(most).run()
        if not search.laws(best):
            return None, _NO_BETTER
    return account(search, best, kept, held_out), ""


def account(
    search: LawSearch[C], best: Fit[C], kept: BoolArray, held_out: FloatArray | None = None
) -> Characterised[C]:
    """What is told of a model that a search has found.

    Args:
        search: With its fits.
        best: Holds one law at least.
        kept: Rows that count, shape (n,).
        held_out: Residual of rows that no choice has seen, shape (n, c); without it that of rows that no fit has seen.
    """
    problem = search.problem
    held_out = best.held_out if held_out is None else held_out
    residual = rmse(held_out, kept, problem.components)
    squares = np.array(
        [
            (np.sum(held_out[rows] ** 2), problem.components * rows.sum())
            for c in np.unique(problem.configuration[kept])
            for rows in [kept & (problem.configuration == c)]
        ]
    )
    drawn = squares[resampled(len(squares), _DRAWS)].sum(axis=1)
    low, high = np.quantile(np.sqrt(drawn[:, 0] / drawn[:, 1]), [0.025, 0.975])
    laws = sorted(_laws(search, best, kept), key=lambda law: -round(law.without / residual, 6))
    return Characterised(
        best, laws, residual, squares[:, 0] / squares[:, 1], (float(low), float(high)), problem
    )


def _laws(search: LawSearch[C], best: Fit[C], kept: BoolArray) -> list[UnnamedLaw[C]]:
    problem = search.problem
    places: dict[tuple[str, str], list[C]] = {}
    for term in search.laws(best):
        places.setdefault(search.place(term).key, []).append(term)
    found = []
    for (where, driver), terms in places.items():
        rest = search.without(best, *terms)
        weights = [term.values(best.theta[best.part(term)], problem.case) for term in terms]
        found.append(
            UnnamedLaw(
                where=where,
                acts_on=search.place(terms[0]).acts_on,
                driver=driver,
                law="; ".join(law_in_words(term, own) for term, own in zip(terms, weights, strict=True)),
                terms=tuple(terms),
                without=rmse(rest.held_out, kept, problem.components),
                rivals=_rivals(search, best, terms, search.place),
                test=test_of(driver),
            )
        )
    return found


def _rivals(search: LawSearch[C], best: Fit[C], terms: Sequence[C], place_of: Places) -> tuple[Rival[C], ...]:
    """Other places and drivers in the place of a law's only term that would do nearly as well."""
    if len(terms) > 1:
        return ()
    own = place_of(terms[0]).key
    listed: dict[tuple[str, str], Rival[C]] = {}
    for other, found in search.rivals(best, terms[0]):
        behind = search.total(found) - search.total(best)
        place = place_of(other).key
        if place != own and behind < EQUAL and place not in listed:
            listed[place] = Rival(other, *place, round(behind, 3))
    return tuple(listed.values())[:_RIVALS]
