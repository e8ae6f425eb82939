"""A search over terms of laws beside causes that are established: the same fits and scores as for causes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.beam import ENTRY, BeamSearch, may_join
from doormill_ros.diagnosis.core.fit import Fit
from doormill_ros.diagnosis.core.problem import Problem
from doormill_ros.diagnosis.core.ranking import QUANTUM, ranks
from doormill_ros.diagnosis.law.place import place_of
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.elastic.law.term import LawTerm

_EACH = 2  #: terms of one place and driver that are fitted in full after the preview
_SCREEN = 10  #: terms that are, over all
#: Score that a term has to gain in the preview, its price paid, to be fitted.
_PROMISING = 0.0
#: What a curve has to be better by than a closed law.
_CURVE = 5.0
_REFINEMENTS = 6  #: rounds in which a rough number of a shape may move


class LawSearch(BeamSearch[ElasticCause]):
    """A model of established causes, which stay, and of terms, which have to earn their place."""

    largest, beam = 7, 2

    def __init__(
        self,
        problem: Problem[ElasticCause],
        base: Sequence[ElasticCause],
        theta: FloatArray,
        terms: Sequence[ElasticCause],
        progress: Callable[[str], None] = lambda line: None,
    ) -> None:
        """Keep what stays, with its numbers theta, shape (p,), and what may join."""
        super().__init__(problem, [*base, *terms], progress)
        self.base, self.theta = tuple(base), theta
        self._stays = {cause.identity for cause in base}
        self._alike = Counter(term.key for term in self.candidates)

    def starts(self) -> list[Fit[ElasticCause]]:
        """The established causes."""
        return [self.fit(self.base, [self.theta])]

    def laws(self, model: Fit[ElasticCause]) -> list[ElasticCause]:
        """Members that are not established."""
        return [member for member in model.members if member.identity not in self._stays]

    def total(self, found: Fit[ElasticCause]) -> float:
        """With the price of a choice: of thirty numbers of waves one fits better than the others by chance."""
        return super().total(found) + sum(map(self._choice, found.members))

    def _choice(self, term: ElasticCause) -> float:
        curve = isinstance(term, LawTerm) and term.shape == "curve"
        return 2.0 * float(np.log(max(self._alike[term.key], 1))) + _CURVE * curve

    @cached_property
    def _prices(self) -> FloatArray:
        """Of every candidate, its numbers included, shape (candidates,)."""
        each = max(np.log(self.problem.components * len(self.problem)) - 2.0, 1.0)
        return np.array([each * term.size + self._choice(term) for term in self.candidates])

    def order(self, found: Fit[ElasticCause]) -> tuple[int, int, list[int]]:
        """Fewer numbers first, then the order of the dictionary; a refined number ranks as the rough one."""
        return 0, found.size, sorted(self._first[member.key] for member in found.members)

    @cached_property
    def _first(self) -> dict[tuple[str, str], int]:
        return {cause.key: place for place, cause in reversed(list(enumerate(self.candidates)))}

    def extensions(self, found: Fit[ElasticCause]) -> list[tuple[ElasticCause, float]]:
        """Of every place and driver the most promising terms."""
        # Less their prices: a curve of five numbers fits whatever one number fits.
        gains = self._preview.gains(found) - self._prices
        listed: Counter[tuple[str, str]] = Counter()
        chosen: list[tuple[ElasticCause, float]] = []
        for i in ranks(-gains):
            term, gain = self.candidates[i], float(gains[i])
            if len(chosen) == _SCREEN or (gain < _PROMISING and len(chosen) >= 3):
                break
            place = place_of(term)
            if listed[place] < _EACH and may_join(found.members, term):
                listed[place] += 1
                chosen.append((term, gain))
        return chosen

    def grown(
        self, beam: Sequence[Fit[ElasticCause]], smaller: Fit[ElasticCause] | None, best: Fit[ElasticCause]
    ) -> list[Fit[ElasticCause]]:
        """One term more; pairs of thousands of terms are too many."""
        return super().grown(beam, None, best)

    def useless(
        self, model: Fit[ElasticCause], asked: Sequence[ElasticCause], strictly: bool
    ) -> list[tuple[ElasticCause, float]]:
        """Terms that do not earn their place in full; what is established stays."""
        terms = [term for term in asked if term.identity not in self._stays]
        gains = [(term, self.total(self.without(model, term)) - self.total(model)) for term in terms]
        return [(term, gain) for term, gain in gains if gain < ENTRY]

    def offers(self, model: Fit[ElasticCause], instead: ElasticCause) -> list[ElasticCause]:
        """Nothing for an established cause."""
        return [] if instead.identity in self._stays else super().offers(model, instead)

    def finished(self, best: Fit[ElasticCause]) -> Fit[ElasticCause]:
        """With the numbers of its shapes at their best."""
        return self.prune(self.refined(super().finished(best)), strictly=True)

    def refined(self, best: Fit[ElasticCause]) -> Fit[ElasticCause]:
        """The model with rough numbers of its shapes moved as long as that predicts better."""
        for _ in range(_REFINEMENTS):
            before = best
            for term in self.laws(best):
                if isinstance(term, LawTerm):
                    rest = self.without(best, term)
                    near = [self.add(rest, other) for other in term.neighbours(self.problem.case)]
                    best = self.ranked([best, *near])[0]
            if self.total(best) > self.total(before) - QUANTUM:
                return before
        return best
