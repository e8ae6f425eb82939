"""The one way through sets of causes: what earns its place joins, what does not leaves, what fits better takes over.

How models are fitted and compared is the business of a kind of fit, see `beam` for the one that most kinds share.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import combinations
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from doormill_ros.diagnosis.core.fitting.ranking import ranked
from doormill_ros.robot_model.candidate import Cause


class Model(Protocol):
    """What a search knows of a fitted model."""

    @property
    def members(self) -> tuple[Any, ...]:
        """Its causes."""


#: Kind of cause that is searched for, and of fitted model.
K = TypeVar("K", bound=Cause)
M = TypeVar("M", bound=Model)


class Search(ABC, Generic[K, M]):
    """Finds which causes earn their place.

    Attributes:
        progress: Called with one line a step.
        largest: Causes in one model up to which further ones join; 0 where all are in from the start.
        beam: Models of every size that are kept; with one, what a newcomer made useless leaves at once.
        looked_at: Of the best larger models, for one that is more than chance.
        swaps: Members that are exchanged at most.
        shapes_last: Whether shapes without a name are for what named causes leave alone.
        at_once: Share of the useless members that leave together, at least one; the others alone are asked again then.
    """

    progress: Callable[[str], None] = staticmethod(lambda line: None)
    largest: int = 0
    beam: ClassVar[int] = 1
    looked_at: ClassVar[int] = 1
    swaps: ClassVar[int] = 0
    shapes_last: ClassVar[bool] = False
    at_once: ClassVar[float] = 0.0

    @abstractmethod
    def starts(self) -> Sequence[M]:
        """Models from which the search sets out."""

    @abstractmethod
    def ranked(self, models: Iterable[M]) -> list[M]:
        """Models by what they leave of rows left out and by what their numbers cost, the best first."""

    @abstractmethod
    def without(self, model: M, *causes: K) -> M:
        """The same model less some members."""

    @abstractmethod
    def useless(self, model: M, asked: Sequence[K], strictly: bool) -> list[tuple[K, float]]:
        """Those of some members that do not earn their place, each with what the model gains by it all the same.

        Args:
            model: The model.
            asked: Its members in question.
            strictly: Whether nothing else is going to join that would put an odd number right.
        """

    def grown(self, beam: Sequence[M], smaller: M | None, best: M) -> list[M]:
        """Models with one member more than those of a beam; none where everything was in from the start.

        Args:
            beam: The best models of a size.
            smaller: The best with one member less, None at first.
            best: The best so far.
        """
        return []

    def earns(self, smaller: M, larger: M) -> bool:
        """Whether what the last member of a model brings is more than chance."""
        return False

    def offers(self, model: M, instead: K) -> Sequence[K]:
        """What may join a model in the place of a member that left it."""
        return ()

    def add(self, model: M, cause: K) -> M | None:
        """A model with one more member; None where that is not plausible."""
        return None

    def better(self, one: M, other: M) -> bool:
        """Whether a model that ranks before another is worth the exchange."""
        return True

    def settled(self, model: M) -> M:
        """A model fitted to the end, where steps of the search are taken by a shorter way."""
        return model

    def simpler(self, best: M) -> M:
        """The model that was found, or one in which a few causes say as much as many."""
        return best

    def run(self, starts: Sequence[M] = ()) -> M:
        """The best model, from some models on; without any from those of the search."""
        return self.simpler(self.ranked([self.climbed(start) for start in starts or self.starts()])[0])

    def climbed(self, start: M) -> M:
        """The best model that single steps lead to."""
        best, beam, smaller = start, [start], None
        seen = {_identity(best)}
        while len(best.members) < self.largest:
            grown = self.grown(beam, smaller, best)
            larger = self.first_earning(best, grown)
            if larger is None:
                break
            smaller, best = beam[0], larger
            if self.beam > 1:
                beam = self.ranked(grown)[: self.beam]
            else:
                best = self.prune(self.settled(larger))
                beam = [best]
            self.progress(self.told(best))
            # What left with the newcomer, or for it, would come and go for ever.
            if len(best.members) <= len(larger.members) - 2 or _identity(best) in seen:
                break
            seen.add(_identity(best))
        return self.finished(best)

    def told(self, best: M) -> str:
        """The line on a step."""
        return f"models of {len(best.members)}: best " + " + ".join(map(repr, best.members))

    def first_earning(self, best: M, grown: Sequence[M]) -> M | None:
        """The best of some larger models that earns it, None for none."""
        turns: list[Sequence[M]] = [grown]
        if self.shapes_last:
            turns = [[one for one in grown if one.members[-1].named == named] for named in (True, False)]
        for models in turns:
            for model in self.ranked(models)[: self.looked_at]:
                if self.earns(best, model):
                    return model
        return None

    def prune(self, best: M, strictly: bool = False) -> M:
        """Drop members without which the model is as good, the least useful first; `strictly` as for `useless`."""
        asked: Sequence[K] = best.members
        while asked and (weak := ranked(self.useless(best, asked, strictly), lambda pair: pair[1])):
            count = max(1, int(self.at_once * (len(weak) + 1)))
            best = self.without(best, *(cause for cause, _ in weak[:count]))
            again = {id(cause) for cause, _ in weak[count:]}
            asked = [cause for cause in best.members if not self.at_once or id(cause) in again]
        return best

    def swapped(self, best: M) -> M:
        """Put another cause for a member where that is better: the order in which they came must not matter.

        Two members give way to two others at once where no single one does: of two wrong causes each can hold up the
        other.
        """
        for _ in range(self.swaps):
            for others in self._exchanged(best):
                first = self.ranked([best, *others])[0]
                if first is not best and self.better(first, best):
                    best = self.settled(first)
                    break
            else:
                return best
        return best

    def _exchanged(self, best: M) -> Iterator[list[M]]:
        for cause in best.members:
            yield [model for _, model in self.rivals(best, cause)]
        for one, other in combinations(best.members, 2):
            yield list(self.two_instead(best, one, other))

    def two_instead(self, model: M, one: K, other: K) -> Sequence[M]:
        """Models with two other causes in the place of two members; none where no kind of fit looks for them."""
        return ()

    def finished(self, best: M) -> M:
        """A model that was found, less what it can do without, with the best causes in every place."""
        best = self.swapped(self.prune(best))
        while (smaller := self.prune(best := self.settled(best), strictly=True)) is not best:
            best = smaller
        return best

    def rivals(self, model: M, cause: K) -> list[tuple[K, M]]:
        """Every other candidate in the place of one member, the best first."""
        rest = self.without(model, cause)
        pairs = [
            (other, found)
            for other in self.offers(rest, cause)
            if (found := self.add(rest, other)) is not None
        ]
        place = {id(found): at for at, found in enumerate(self.ranked([found for _, found in pairs]))}
        return sorted(pairs, key=lambda pair: place[id(pair[1])])


def _identity(model: Model) -> frozenset[tuple[str, str, str]]:
    return frozenset(member.identity for member in model.members)
