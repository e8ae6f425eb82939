"""A beam search over sets of causes, each model fitted by robust least squares and scored on what was held out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from itertools import islice
from typing import ClassVar, Generic

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.fit import Fit, Identity, fit
from doormill_ros.diagnosis.core.fitting.kinks import polish
from doormill_ros.diagnosis.core.fitting.price import LEFT_OUT, price_of_number
from doormill_ros.diagnosis.core.fitting.problem import C, Problem
from doormill_ros.diagnosis.core.fitting.ranking import QUANTUM, ranked, ranks
from doormill_ros.diagnosis.core.searching.preview import Preview
from doormill_ros.diagnosis.core.searching.search import Search

#: Score by which a cause must improve the held-out prediction. A pattern of pure noise reaches
#: this with a chance of 1e-5; times a hundred candidates that is one false alarm in a thousand.
ENTRY = 20.0
#: What an unnamed pattern must be better by than a cause that does the same.
PATTERN_PENALTY = 2.0
#: Score within which two models count as equally good: odds of e^5, about 150 to 1.
EQUAL = 10.0
_SCREEN = 10  #: candidates that are fitted in full after the linear preview
_PAIRS = 8  #: pairs of candidates that are


class BeamSearch(Search[C, Fit[C]], Generic[C]):
    """All models of a problem that were fitted, and the way to more of them.

    Attributes:
        problem: The set.
        candidates: Causes and patterns that may enter.
        fits: Fitted models by the identities of their members.
        two_at_once: Pairs that are fitted in the place of two members at most.
    """

    largest = swaps = 4
    beam = 5
    two_at_once: ClassVar[int] = 4

    def __init__(
        self,
        problem: Problem[C],
        candidates: Sequence[C],
        progress: Callable[[str], None] = lambda line: None,
    ) -> None:
        """Keep what may enter; `progress` is called with one line a step."""
        self.problem, self.candidates, self.progress = problem, candidates, progress
        self.fits: dict[Identity, Fit[C]] = {}
        self._polished: set[tuple[Identity, Identity]] = set()
        self._walked: set[Identity] = set()

    def starts(self) -> list[Fit[C]]:
        """The model in question."""
        return [self.fit(())]

    def fit(self, members: Iterable[C], starts: Sequence[FloatArray] | None = None) -> Fit[C]:
        """Fit a model once, from the starts given, shape (p,) each, or of its own."""
        members = tuple(members)
        key = frozenset(cause.identity for cause in members)
        if key not in self.fits:
            self.fits[key] = self.fitted(members, starts)
        return self.fits[key]

    def fitted(self, members: Sequence[C], starts: Sequence[FloatArray] | None) -> Fit[C]:
        """A fit of its own, whatever there is already, from the starts given, shape (p,) each."""
        return fit(self.problem, members, starts)

    def total(self, found: Fit[C]) -> float:
        """Held-out score plus what its numbers and unnamed patterns cost; smaller is better."""
        each = price_of_number(self.problem.components * len(self.problem))
        # A number at a kink stays where it is when rows are left out: it pays nothing there.
        kinked = sum(len(cause.kinked) for cause in found.members)
        unnamed = sum(not cause.named for cause in found.members)
        price = each * found.size + LEFT_OUT * kinked + PATTERN_PENALTY * unnamed
        return float(found.held_out_score + price)

    def order(self, found: Fit[C]) -> tuple[int, int, list[int]]:
        """What goes first among equals: the measuring chain before the robot, fewer numbers, the library's order."""
        return (
            sum(cause.of_robot for cause in found.members),
            found.size,
            sorted(self._place[cause.identity] for cause in found.members),
        )

    def ranked(self, fits: Iterable[Fit[C]]) -> list[Fit[C]]:
        """Models by their totals, the best first."""
        return ranked(fits, self.total, self.order)

    @cached_property
    def _place(self) -> dict[tuple[str, str, str], int]:
        return {cause.identity: place for place, cause in enumerate(self.candidates)}

    def extensions(self, found: Fit[C]) -> list[tuple[C, float]]:
        """Candidates that may join a model and by how much, to first order; the most promising first."""
        gains = self.gains(found)
        allowed = [
            (cause, gain)
            for cause, gain in zip(self.candidates, gains, strict=True)
            if may_join(found.members, cause)
        ]
        allowed = [allowed[i] for i in ranks(np.array([-gain for _, gain in allowed]))]
        return [pair for i, pair in enumerate(allowed) if pair[1] > 0.5 * ENTRY or i < 3][:_SCREEN]

    def gains(self, found: Fit[C]) -> FloatArray:
        """By how much the score may fall when each candidate joins, to first order, shape (candidates,)."""
        return self._preview.gains(found)

    @cached_property
    def _preview(self) -> Preview[C]:
        return Preview(self.problem, self.candidates)

    def grown(self, beam: Sequence[Fit[C]], smaller: Fit[C] | None, best: Fit[C]) -> list[Fit[C]]:
        """Models with one member more than those of a beam, and with two more than the best of a smaller size."""
        grown: dict[Identity, Fit[C]] = {}
        for parent in beam:
            for cause, gain in self.extensions(parent):
                # The preview is to first order: leave it a factor of two.
                if parent is not beam[0] and self.total(parent) - 2.0 * gain > self.total(best):
                    continue
                child = self.add(parent, cause)
                grown[child.identity] = child
        if smaller is not None:
            grown |= {child.identity: child for child in self._grow_by_pairs(smaller, best)}
        return list(grown.values())

    def _grow_by_pairs(self, found: Fit[C], best: Fit[C]) -> list[Fit[C]]:
        """Models with two members more than one of a smaller size, for effects that only show together."""
        freedom = self.problem.components * len(self.problem)
        if best.held_out_score < freedom + 3.0 * np.sqrt(2.0 * freedom):
            return []  # nothing is left for a pair to gain
        pairs = islice(self.promising(found, best), _PAIRS)
        return [self.add(self.add(found, one), two) for one, two in pairs]

    def promising(self, found: Fit[C], best: Fit[C], doubt: float = 2.0) -> Iterator[tuple[C, C]]:
        """Pairs that may bring a model as low as another; `doubt` is the factor that the first order is left."""
        for one, two, gain in self.pairs(found):
            if found.held_out_score - doubt * gain > best.held_out_score:
                break
            yield one, two

    def pairs(self, found: Fit[C]) -> Iterator[tuple[C, C, float]]:
        """Pairs that may join a model and by how much, to first order; the most promising first."""
        numbers, gains = self._preview.pairs(found)
        for (i, j), gain in zip(numbers, gains, strict=True):
            one, two = self.candidates[i], self.candidates[j]
            if may_join(found.members, one) and may_join((*found.members, one), two):
                yield one, two, float(gain)

    def two_instead(self, model: Fit[C], one: C, other: C) -> list[Fit[C]]:
        """The most promising pairs of other candidates in the place of two members."""
        if not self.two_at_once:
            return []
        rest, left = self.without(model, one, other), {one.identity, other.identity}
        # With one of the two in its place again it is an exchange of one.
        pairs = (
            pair for pair in self.promising(rest, model, doubt=1.0) if not left & {c.identity for c in pair}
        )
        return [self.add(self.add(rest, first), second) for first, second in islice(pairs, self.two_at_once)]

    def earns(self, smaller: Fit[C], larger: Fit[C]) -> bool:
        """Whether the held-out score falls by more than chance makes it."""
        return self.total(larger) <= self.total(smaller) - ENTRY

    def told(self, best: Fit[C]) -> str:
        """How many models were tried, and the best of them."""
        names = " + ".join(map(repr, best.members))
        return f"models of {len(best.members)}: {len(self.fits)} tried so far, best {names}"

    def finished(self, best: Fit[C]) -> Fit[C]:
        """With the simplest law of every name, its kinked numbers at their best."""
        return self.polished(self._simplify(super().finished(best)))

    def polished(self, found: Fit[C]) -> Fit[C]:
        """The model with its kinked numbers at their best; equals must be compared that way."""
        if any(cause.kinked for cause in found.members) and found.identity not in self._walked:
            self._walked.add(found.identity)
            self.fits[found.identity] = polish(self.problem, found)
        return self.fits[found.identity]

    def _simplify(self, best: Fit[C]) -> Fit[C]:
        """Put a simpler law for one of another name that contains it, unless that is clearly better.

        One more number in a law is one more cause in all but name: where both count as equally good, the name that
        claims more is not earned. It is listed beside the simpler one then.
        """
        for cause in best.members:
            for other, found in self.rivals(best, cause):
                simpler = other.where == cause.where and other.name == cause.generalises != cause.name
                if simpler and self.total(found) < self.total(best) + EQUAL:
                    return self._simplify(found)
        return best

    def add(self, parent: Fit[C], cause: C) -> Fit[C]:
        """A model with one more member, started from what is known of the others."""
        starts = [np.concatenate([parent.theta, start]) for start in cause.starts(self.problem.case)]
        return self.fit((*parent.members, cause), starts)

    def useless(self, model: Fit[C], asked: Sequence[C], strictly: bool) -> list[tuple[C, float]]:
        """Members without which the model is as good."""
        gains = [(cause, self.total(self.without(model, cause)) - self.total(model)) for cause in asked]
        return [(cause, gain) for cause, gain in gains if gain < ENTRY / 2.0]

    def without(self, model: Fit[C], *causes: C) -> Fit[C]:
        """The same model less some members, fitted anew, also from where the others stand now."""
        rest = tuple(c for c in model.members if all(c is not cause for cause in causes))
        theta = np.concatenate([np.zeros(0), *(model.theta[model.part(c)] for c in rest)])
        return self._fitted_from(model, rest, theta)

    def _exchanged(self, best: Fit[C]) -> Iterator[list[Fit[C]]]:
        """First with a number that is tried at some values at the others: nothing else has to move for it.

        Without that member the others take over what they can, and from there the way back may lead elsewhere: a weight
        that tells a joint which flank it lies against, say, where a gap of another crossing would do.
        """
        yield [
            self._fitted_from(
                best, [other if member is cause else member for member in best.members], best.theta
            )
            for cause in best.members
            for other in self.candidates
            if cause.series and (other.key, other.series) == (cause.key, cause.series) and other is not cause
        ]
        yield from super()._exchanged(best)

    def _fitted_from(self, model: Fit[C], members: Sequence[C], theta: FloatArray) -> Fit[C]:
        """A model like another one, fitted from starts of its own and from where that one stands, shape (p,)."""
        found = self.fit(members)
        tried = (model.identity, found.identity)
        if members and tried not in self._polished:
            self._polished.add(tried)
            again = self.fitted(members, [theta])
            if again.score < found.score - QUANTUM:
                self.fits[again.identity] = found = again
        return found

    def offers(self, model: Fit[C], instead: C) -> list[C]:
        """The most promising candidates but for the one that left."""
        return [other for other, _ in self.extensions(model) if other.identity != instead.identity]


def may_join(members: Sequence[C], cause: C) -> bool:
    """Whether a cause is new to a model, and no member at its place is a law that contains it or is contained in it."""
    return not any(
        cause.key == member.key
        or (
            cause.where == member.where
            and (cause.generalises == member.name or member.generalises == cause.name)
        )
        for member in members
    )
