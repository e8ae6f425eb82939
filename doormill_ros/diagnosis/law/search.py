"""A search over terms of laws beside causes that are established: the same fits and scores as for causes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import Generic

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.fitting.price import price_of_number
from doormill_ros.diagnosis.core.fitting.problem import C, Problem
from doormill_ros.diagnosis.core.fitting.ranking import QUANTUM, ranks
from doormill_ros.diagnosis.core.searching.beam import ENTRY, BeamSearch, may_join
from doormill_ros.diagnosis.law.beside import Beside
from doormill_ros.diagnosis.law.place import Places
from doormill_ros.robot_model.law.term import Term

_EACH = 2  #: terms of one place and driver that are fitted in full after the preview
_SCREEN = 10  #: terms that are, over all
#: Score that a term has to gain in the preview, its price paid, to be fitted.
_PROMISING = 0.0
#: What a curve has to be better by than a closed law.
_CURVE = 5.0
_REFINEMENTS = 6  #: rounds in which a rough number of a shape may move


class LawSearch(BeamSearch[C], Generic[C]):
    """A model of established causes, which stay, and of terms, which have to earn their place."""

    largest, beam = 7, 2
    two_at_once = 0  # pairs of thousands of terms are too many to look at

    def __init__(
        self,
        problem: Problem[C],
        base: Sequence[C],
        theta: FloatArray,
        terms: Sequence[C],
        place: Places,
        progress: Callable[[str], None] = lambda line: None,
        spread: bool = False,
        beside: Beside | None = None,
    ) -> None:
        """Keep what stays, with its numbers theta, shape (p,), and what may join.

        Args:
            problem: What is left to explain.
            base: What stays.
            theta: Its numbers.
            terms: What may join.
            place: Where a candidate acts.
            progress: Told of every step.
            spread: Whether a term has to earn its place without the one configuration that gains most, too; for rows
                that repeat their neighbours.
            beside: Fits terms beside what stays without fitting that again; for what is linear.
        """
        super().__init__(problem, [*base, *terms], progress)
        self.base, self.theta, self.place, self.spread = tuple(base), theta, place, spread
        self._beside = beside
        self._stays = {cause.identity for cause in base}
        self._alike = Counter(term.key for term in self.candidates)

    def on(self, problem: Problem[C]) -> LawSearch[C]:
        """The same search on other rows."""
        terms = self.candidates[len(self.base) :]
        return LawSearch(problem, self.base, self.theta, terms, self.place, spread=self.spread)

    @property
    def most(self) -> int:
        """Laws that may join."""
        return max(self.largest - len(self.base), 0)

    def at_most(self, laws: int) -> LawSearch[C]:
        """The same search, with its fits, for so many laws."""
        fewer = copy(self)
        fewer.largest = len(self.base) + laws
        return fewer

    def starts(self) -> list[Fit[C]]:
        """The established causes."""
        return [self.fit(self.base, [self.theta])]

    def fitted(self, members: Sequence[C], starts: Sequence[FloatArray] | None) -> Fit[C]:
        """Fitted anew, from the starts given, shape (p,) each."""
        return super().fitted(members, starts) if self._beside is None else self._beside.fit(members, starts)

    def gains(self, found: Fit[C]) -> FloatArray:
        """By how much the score may fall when each candidate joins, to first order, shape (candidates,)."""
        return super().gains(found) if self._beside is None else self._beside.gains(found, self.candidates)

    def laws(self, model: Fit[C]) -> list[C]:
        """Members that are not established."""
        return [member for member in model.members if member.identity not in self._stays]

    def total(self, found: Fit[C]) -> float:
        """With the price of a choice: of thirty numbers of waves one fits better than the others by chance."""
        return super().total(found) + sum(map(self._choice, found.members))

    def _choice(self, term: C) -> float:
        curve = isinstance(term, Term) and not term.follows.closed
        return 2.0 * float(np.log(max(self._alike[term.key], 1))) + _CURVE * curve

    @cached_property
    def _prices(self) -> FloatArray:
        """Of every candidate, its numbers included, shape (candidates,)."""
        each = price_of_number(self.problem.components * len(self.problem))
        return np.array([each * term.size + self._choice(term) for term in self.candidates])

    def order(self, found: Fit[C]) -> tuple[int, int, list[int]]:
        """Fewer numbers first, then the order of the dictionary; a refined number ranks as the rough one."""
        return 0, found.size, sorted(self._first[member.key] for member in found.members)

    @cached_property
    def _first(self) -> dict[tuple[str, str], int]:
        return {cause.key: place for place, cause in reversed(list(enumerate(self.candidates)))}

    def extensions(self, found: Fit[C]) -> list[tuple[C, float]]:
        """Of every place and driver the most promising terms."""
        # Less their prices: a curve of five numbers fits whatever one number fits.
        gains = self.gains(found) - self._prices
        listed: Counter[tuple[str, str]] = Counter()
        chosen: list[tuple[C, float]] = []
        for i in ranks(-gains):
            term, gain = self.candidates[i], float(gains[i])
            if len(chosen) == _SCREEN or (gain < _PROMISING and len(chosen) >= 3):
                break
            if not may_join(found.members, term):  # nor what is established, which has no place
                continue
            place = self.place(term).key
            if listed[place] < _EACH:
                listed[place] += 1
                chosen.append((term, gain))
        return chosen

    def grown(self, beam: Sequence[Fit[C]], smaller: Fit[C] | None, best: Fit[C]) -> list[Fit[C]]:
        """One term more; pairs of thousands of terms are too many."""
        return super().grown(beam, None, best)

    def useless(self, model: Fit[C], asked: Sequence[C], strictly: bool) -> list[tuple[C, float]]:
        """Terms that do not earn their place in full; what is established stays."""
        terms = [term for term in asked if term.identity not in self._stays]
        gains = [(term, self._gain(self.without(model, term), model)) for term in terms]
        return [(term, gain) for term, gain in gains if gain < ENTRY]

    def earns(self, smaller: Fit[C], larger: Fit[C]) -> bool:
        """Whether the held-out score falls by more than chance makes it."""
        return self._gain(smaller, larger) >= ENTRY

    def _gain(self, smaller: Fit[C], larger: Fit[C]) -> float:
        """What a larger model gains, its numbers paid."""
        gain = self.total(smaller) - self.total(larger)
        if self.spread and gain > 0.0:
            fall = np.bincount(self._configuration, weights=smaller.held_out_cost - larger.held_out_cost)
            gain *= 1.0 - float(fall.max()) / max(float(fall[fall > 0.0].sum()), 1e-300)
        return gain

    @cached_property
    def _configuration(self) -> IntArray:
        return np.unique(self.problem.configuration, return_inverse=True)[1]

    def offers(self, model: Fit[C], instead: C) -> list[C]:
        """Nothing for an established cause."""
        return [] if instead.identity in self._stays else super().offers(model, instead)

    def finished(self, best: Fit[C]) -> Fit[C]:
        """With the numbers of its shapes at their best."""
        return _ended(self.prune(self.refined(super().finished(best)), strictly=True))

    def refined(self, best: Fit[C]) -> Fit[C]:
        """The model with rough numbers of its shapes moved as long as that predicts better."""
        for _ in range(_REFINEMENTS):
            before = best
            for term in self.laws(best):
                if isinstance(term, Term):
                    rest = self.without(best, term)
                    near = [self.add(rest, other) for other in term.neighbours(self.problem.case)]
                    best = self.ranked([best, *near])[0]
            if self.total(best) > self.total(before) - QUANTUM:
                return before
        return best


def _ended(best: Fit[C]) -> Fit[C]:
    """The model with terms ended that make up one curve of one thing over a driver: none of them goes on by itself.

    Beyond what was seen they would no longer cancel. A level has no end, and what repeats itself was seen whole.
    """
    bends = [term for term in best.members if isinstance(term, Term) and not term.follows.constant]
    together = Counter((term.where, term.acts_on, term.driver) for term in bends)
    members = tuple(
        term.ended()
        if isinstance(term, Term) and together[term.where, term.acts_on, term.driver] > 1 and not term.repeats
        else term
        for term in best.members
    )
    return replace(best, members=members)
