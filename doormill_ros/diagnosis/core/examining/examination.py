"""Which members of a model may be named, what would do as well, and how far every decision was from its threshold.

The course is the same for every kind of fit; what a member has to stand there is the business of its `Examiner`, see
`fit_examiner` for the one that most kinds share.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Generic, Self, TypeVar

import numpy as np

from doormill_ros.diagnosis.core.searching.search import K, M, Search
from doormill_ros.diagnosis.core.words.margin import Check, Margin

#: Why a cause is not named that explains too little.
MOST_REMAINS = "most of what is wrong remains"


@dataclass(frozen=True, eq=False)
class Double(Generic[K, M]):
    """Another cause that would do as well as a named one.

    Attributes:
        cause: The cause.
        behind: By how much the score of a model with it is larger; None where only the effects overlap.
        tied: Whether the data say nothing at all between the two: a fixed order chose the name.
        model: The model that holds it in the place of the named one, where there is one.
    """

    cause: K
    behind: float | None = None
    tied: bool = False
    model: M | None = None


@dataclass(frozen=True, eq=False)
class Examination(Generic[K, M]):
    """What may be named of the best model.

    Attributes:
        best: The best model found, shapes without a name included.
        asked: The model whose members were weighed: the best one, or that of named causes.
        baseline: The model in question.
        extended: The model of what may be named.
        named: What may be.
        refused: The other named members of the best model, each with the reason.
        kept: Rows that count, in a form of the question's own.
        margins: How far every decision was from its threshold.
        doubles: What would do as well as each that is named.
    """

    best: M
    asked: M
    baseline: M
    extended: M
    named: tuple[K, ...]
    refused: tuple[tuple[K, str], ...]
    kept: Any
    margins: tuple[Margin, ...]
    doubles: tuple[tuple[Double[K, Any], ...], ...] = ()

    def withdrawn(self) -> Self:
        """The same with nothing named."""
        return self.fewer(self.named, MOST_REMAINS, self.baseline)

    def fewer(self, causes: Sequence[K], why: str, extended: M) -> Self:
        """The same with fewer names, for a reason; `extended` is the model of the others."""
        return replace(
            self,
            extended=extended,
            named=tuple(cause for cause in self.named if cause not in causes),
            refused=(*self.refused, *((cause, why) for cause in causes)),
            doubles=(),
        )


#: Of some kind of cause and model.
E = TypeVar("E", bound=Examination[Any, Any])


class Examiner(ABC, Generic[K, M]):
    """What a kind of fit says for and against the members of its models.

    Attributes:
        models: All that were tried.
        equal: Score within which two models are equally good.
    """

    models: Search[K, M]
    equal: ClassVar[float]

    @abstractmethod
    def baseline(self) -> M:
        """The model in question."""

    @abstractmethod
    def noise(self, model: M) -> Sequence[Check]:
        """What shows that a model leaves more than noise: one check that fails is enough."""

    @abstractmethod
    def checks(self, best: M, cause: K, remains: bool) -> Sequence[Check]:
        """What a named member of the best model has to stand; `remains` tells that the model leaves more than noise."""

    @abstractmethod
    def settled(
        self, best: M, named: Sequence[K], refused: Sequence[tuple[K, str]], remains: bool
    ) -> tuple[M, M, Sequence[tuple[K, str]]]:
        """The model of what may be named.

        Args:
            best: The best model.
            named: Its members that stood every check.
            refused: The others that have a name, with what is said of them.
            remains: Whether the best model leaves more than noise.

        Returns:
            The model whose members are to be weighed, the extended model, and what is refused only now.
        """

    @abstractmethod
    def worth(self, asked: M) -> Sequence[Margin]:
        """What each member of a model brings, and what a further one would."""

    @abstractmethod
    def behind(self, model: M, rival: M) -> float:
        """By how much the score of a rival is larger."""

    @abstractmethod
    def doubles(self, asked: M, cause: K) -> Sequence[Double[K, M]]:
        """What would do as well in the place of a member."""

    def remains(self, model: M) -> bool:
        """Whether a model leaves more than noise."""
        return any(check.fails for check in self.noise(model))


def examined(examiner: Examiner[K, M], best: M, kept: Any = None) -> Examination[K, M]:
    """Ask every member of the best model; `kept` are the rows that count, in a form of the question's own."""
    remains, baseline = examiner.remains(best), examiner.baseline()
    stood: list[K] = []
    refused: list[tuple[K, str]] = []
    margins: list[Margin] = []
    for cause in best.members:
        if not cause.named:
            continue
        checks = examiner.checks(best, cause, remains)
        margins += [margin for check in checks for margin in check.margins]
        against = [check.against for check in checks if check.fails]
        if against:
            refused.append((cause, against[0]))
        else:
            stood.append(cause)
    asked, extended, later = examiner.settled(best, stood, refused, remains)
    refused += later
    gone = {id(cause) for cause, _ in refused}
    # Of the model in question only what is not said of the other as well.
    noise = {
        margin.decision: margin
        for model in (baseline, asked)
        for check in examiner.noise(model)
        for margin in check.margins
    }
    return Examination(
        best=best,
        asked=asked,
        baseline=baseline,
        extended=extended,
        named=tuple(cause for cause in asked.members if cause.named and id(cause) not in gone),
        refused=tuple(refused),
        kept=kept,
        margins=(*noise.values(), *margins),
    )


def compared(examiner: Examiner[Any, Any], found: E) -> E:
    """With what would do as well in the place of every cause that is named, and how far the others are."""
    doubles = tuple(tuple(examiner.doubles(found.asked, cause)) for cause in found.named)
    margins = [*examiner.worth(found.asked)]
    for cause, equal in zip(found.named, doubles, strict=True):
        keys = {cause.key, *(double.cause.key for double in equal)}
        behind = [
            examiner.behind(found.asked, rival)
            for other, rival in examiner.models.rivals(found.asked, cause)
            if other.key not in keys
        ]
        if behind:
            margins.append(
                Margin(f"another cause in place of {cause!r}", min(behind), examiner.equal, "score")
            )
    # Where names were taken back this is asked anew: what was said before gives way.
    last = {margin.decision: margin for margin in (*found.margins, *margins)}
    finite = [margin for margin in last.values() if np.isfinite(margin.value)]
    return replace(found, doubles=doubles, margins=tuple(finite))
