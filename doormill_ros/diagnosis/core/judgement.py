"""From a question to a verdict: searched, examined, weighed on rows left out; the same for every kind of data."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.search import K, M
from doormill_ros.diagnosis.core.verdict import CONSISTENT, UNEXPLAINED, judge
from doormill_ros.statistics import bootstrap_ratio

#: Why a cause is not named that explains too little.
MOST_REMAINS = "most of what is wrong remains"


@dataclass(frozen=True, eq=False)
class Examination(Generic[K, M]):
    """What may be named of the best model.

    Attributes:
        best: The best model found, shapes without a name included.
        baseline: The model in question.
        extended: The model of what may be named.
        named: What may be.
        refused: The other named members of the best model, each with the reason.
        kept: Rows that count, in a form of the question's own.
    """

    best: M
    baseline: M
    extended: M
    named: tuple[K, ...]
    refused: tuple[tuple[K, str], ...]
    kept: Any


class Question(Protocol[K, M]):
    """Data that question a model, with what is particular to them.

    Attributes:
        noise_floor: What noise alone leaves.
        main_part: Share of the excess over the noise that causes explain to be named where something remains.
    """

    noise_floor: float
    main_part: float

    def search(self, progress: Callable[[str], None]) -> M:
        """The best model."""

    def examine(self, best: M) -> Examination[K, M]:
        """What may be named of it."""

    def withdrawn(self, examination: Examination[K, M]) -> Examination[K, M]:
        """The same with nothing named."""

    def at_noise(self, model: M, kept: Any) -> bool:
        """Whether a model leaves no more than noise."""

    def train_rmse(self, model: M, kept: Any) -> float:
        """Root mean square of what a model leaves of the rows that count."""

    def holdout_rmse(self, model: M, kept: Any) -> float:
        """The same of rows predicted by the others."""

    def holdout_squares(self, model: M, kept: Any) -> FloatArray:
        """Their sums of squares by what was left out together, shape (groups,)."""


#: A question of some kind.
Q = TypeVar("Q", bound=Question[Any, Any])


@dataclass(frozen=True, eq=False)
class Judgement(Generic[K, M]):
    """What every diagnosis knows.

    Attributes:
        verdict: consistent, explained, partly_explained or unexplained.
        examination: What was searched, and what of it is named.
        train_rmse, holdout_rmse: Of baseline and extended model.
        ratio, ratio_ci: Held-out RMSE extended over baseline, and its 95 % interval.
    """

    verdict: str
    examination: Examination[K, M]
    train_rmse: tuple[float, float]
    holdout_rmse: tuple[float, float]
    ratio: float
    ratio_ci: tuple[float, float]

    @property
    def baseline(self) -> M:
        """The model in question."""
        return self.examination.baseline

    @property
    def extended(self) -> M:
        """The model with the established causes."""
        return self.examination.extended

    @property
    def best(self) -> M:
        """The best model found, shapes without a name included."""
        return self.examination.best


def judge_question(
    question: Question[K, M], progress: Callable[[str], None] = lambda line: None
) -> Judgement[K, M]:
    """Search, examine and weigh."""
    found = question.examine(question.search(progress))
    before, after = (question.holdout_rmse(one, found.kept) for one in (found.baseline, found.extended))
    complete = all(cause.named for cause in found.best.members) and not found.refused
    word = judge(
        found=bool(found.named),
        silent=not found.best.members and question.at_noise(found.baseline, found.kept),
        quiet=complete and question.at_noise(found.extended, found.kept),
        share=(before**2 - after**2) / max(before**2 - question.noise_floor**2, 1e-30),
        main_part=question.main_part,
    )
    if word in (UNEXPLAINED, CONSISTENT):
        found = question.withdrawn(found)
    pair, kept = (found.baseline, found.extended), found.kept
    train, unseen = ([of(one, kept) for one in pair] for of in (question.train_rmse, question.holdout_rmse))
    ratio, interval = bootstrap_ratio(
        question.holdout_squares(found.baseline, kept), question.holdout_squares(found.extended, kept)
    )
    return Judgement(word, found, (train[0], train[1]), (unseen[0], unseen[1]), ratio, interval)
