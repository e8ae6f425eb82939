"""From a question to a verdict: searched, examined, weighed on rows left out; the same for every kind of data."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeVar

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.examining.examination import Examination, Examiner, compared, examined
from doormill_ros.diagnosis.core.searching.search import K, M
from doormill_ros.diagnosis.core.words.margin import Margin
from doormill_ros.diagnosis.core.words.verdict import CONSISTENT, UNEXPLAINED, judge
from doormill_ros.statistics import bootstrap_ratio


class Question(ABC, Generic[K, M]):
    """Data that question a model, with what is particular to them.

    Attributes:
        noise_floor: What noise alone leaves.
        main_part: Share of the excess over the noise that causes explain to be named where something remains.
        examiner: What the members of its models have to stand, as soon as it was searched; where parts of the data are
            searched by themselves there is one for each, and `examine`, `compared` and `at_noise` join what they say.
    """

    noise_floor: float
    main_part: ClassVar[float]
    examiner: Examiner[K, M]

    @abstractmethod
    def search(self, progress: Callable[[str], None]) -> M:
        """The best model."""

    def kept(self, best: M) -> Any:
        """Rows that count, in a form of the question's own."""

    def examine(self, best: M) -> Examination[K, M]:
        """What may be named of it."""
        return examined(self.examiner, best, self.kept(best))

    def withdrawn(self, examination: Examination[K, M]) -> Examination[K, M]:
        """The same with nothing named."""
        return examination.withdrawn()

    def compared(self, examination: Examination[K, M]) -> Examination[K, M]:
        """With what would do as well as every cause that is named."""
        return compared(self.examiner, examination)

    def at_noise(self, model: M) -> bool:
        """Whether a model leaves no more than noise."""
        return not self.examiner.remains(model)

    @abstractmethod
    def train_rmse(self, model: M, kept: Any) -> float:
        """Root mean square of what a model leaves of the rows that count."""

    @abstractmethod
    def holdout_rmse(self, model: M, kept: Any) -> float:
        """The same of rows predicted by the others."""

    def share(self, found: Examination[K, M]) -> float:
        """Share of the excess over the noise, squared, that named causes explain where they act."""
        before, after = (self.holdout_rmse(one, found.kept) for one in (found.baseline, found.extended))
        return (before**2 - after**2) / max(self.excess(found), 1e-30)

    def excess(self, found: Examination[K, M]) -> float:
        """Held-out squared error of the model in question beyond the noise."""
        return self.holdout_rmse(found.baseline, found.kept) ** 2 - self.noise_floor**2

    @abstractmethod
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
        margins: How far every decision was from its threshold.
    """

    verdict: str
    examination: Examination[K, M]
    train_rmse: tuple[float, float]
    holdout_rmse: tuple[float, float]
    ratio: float
    ratio_ci: tuple[float, float]
    margins: tuple[Margin, ...]

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
    return weighed(question, question.examine(question.search(progress)))


def less(question: Question[K, M], found: Judgement[K, M], causes: Sequence[K], why: str) -> Judgement[K, M]:
    """What was judged without some names, for a reason, weighed anew."""
    extended = question.examiner.models.without(found.extended, *causes)
    return weighed(question, found.examination.fewer(causes, why, extended))


def weighed(question: Question[K, M], found: Examination[K, M], stays: bool = False) -> Judgement[K, M]:
    """The verdict on what an examination leaves.

    Args:
        question: The question.
        found: What may be named.
        stays: Whether what is named was weighed before, with names that were taken back for a law: it stays partly
            explained, however much that law's part was.
    """
    complete = all(cause.named for cause in found.best.members) and not found.refused
    beyond, share = question.excess(found), question.share(found)
    word = judge(
        found=bool(found.named),
        silent=not found.best.members and question.at_noise(found.baseline),
        quiet=complete and question.at_noise(found.extended),
        share=share,
        main_part=0.0 if stays else question.main_part,
    )
    most = Margin("the causes explain most of what is beyond the noise", share, question.main_part, "share")
    if word in (UNEXPLAINED, CONSISTENT):
        found = question.withdrawn(found)
    found = question.compared(found)
    pair, kept = (found.baseline, found.extended), found.kept
    train, unseen = ([of(one, kept) for one in pair] for of in (question.train_rmse, question.holdout_rmse))
    ratio, interval = bootstrap_ratio(
        question.holdout_squares(found.baseline, kept), question.holdout_squares(found.extended, kept)
    )
    return Judgement(
        verdict=word,
        examination=found,
        train_rmse=(train[0], train[1]),
        holdout_rmse=(unseen[0], unseen[1]),
        ratio=ratio,
        ratio_ci=interval,
        margins=(*found.margins, *([most] if question.main_part and beyond > 0.0 and not stays else ())),
    )
