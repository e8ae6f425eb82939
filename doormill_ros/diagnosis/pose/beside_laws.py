"""Names asked once more beside laws: what a remainder elsewhere had hidden of a cause shows once that is described.

Laws join the causes of the search as what acts in any case. A name stands where all together leave no more than noise.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace

from doormill_ros.diagnosis.core.judgement import judge_question
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis, PoseQuestion
from doormill_ros.diagnosis.pose.fitting.model import SeriesFit
from doormill_ros.diagnosis.pose.searching.search import PoseSearch
from doormill_ros.robot_model.pose.law.term import PoseTerm


class _BesideLaws(PoseQuestion):
    """Series of poses, asked with laws that act as well: beside what is described a small part is as sure as any."""

    main_part = 0.0

    def __init__(self, question: PoseQuestion, laws: Sequence[PoseTerm]) -> None:
        """Keep the laws, and of a question how its robot stands and how the nominal model places it."""
        super().__init__(question.sets)
        self.standing, self._nominal, self._laws = question.standing, question.examiner.nominal, tuple(laws)

    def search(self, progress: Callable[[str], None]) -> SeriesFit:
        """What is left of everything that may act beside the laws."""
        return self.searched(PoseSearch(self.sets, self._nominal, progress, self._laws), self._nominal)


def asked_beside(
    diagnosis: PoseDiagnosis, laws: Sequence[PoseTerm], progress: Callable[[str], None] = lambda line: None
) -> PoseDiagnosis:
    """The diagnosis with the names that stand beside laws, told without these.

    Args:
        diagnosis: What was said before.
        laws: What acts beside its causes.
        progress: Told of every step.
    """
    progress("asking for causes again beside the laws")
    question = _BesideLaws(diagnosis.question, laws)
    return PoseDiagnosis(**vars(judge_question(question, progress)), question=question)


def with_reasons(again: PoseDiagnosis, before: PoseDiagnosis) -> PoseDiagnosis:
    """A diagnosis with the reasons for which an earlier one took names back that it does not give itself."""
    named = {cause.key for cause in again.examination.named}
    taken_back = [pair for pair in before.examination.refused if pair[0].key not in named]
    keys = {cause.key for cause, _ in taken_back}
    own = again.question
    question = copy.copy(own)
    question.gone = [*(one for one in own.gone if one.key not in keys), *(cause for cause, _ in taken_back)]
    question.scores = own.scores | {id(cause): before.question.scores[id(cause)] for cause, _ in taken_back}
    examination = replace(again.examination, refused=(*again.examination.refused, *taken_back))
    return replace(again, question=question, examination=examination)
