"""Names asked once more beside laws: what a remainder elsewhere had hidden of a cause shows once that is described.

Where laws leave no more than noise, nothing unknown is left that a cause could stand for. Their terms join the shapes
without a name, and search and examination run again from there.
"""

from __future__ import annotations

from collections.abc import Callable, Collection

from doormill_ros.diagnosis.core.diagnosis import FittedQuestion, told
from doormill_ros.diagnosis.core.examining.finding import Finding
from doormill_ros.diagnosis.core.examining.fit_examiner import STRUCTURE, FitExaminer, excess_probability
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.judgement import judge_question
from doormill_ros.diagnosis.core.searching.beam import ENTRY, EQUAL, BeamSearch, may_join
from doormill_ros.diagnosis.core.telling.characterised import Characterised
from doormill_ros.diagnosis.law.search import LawSearch
from doormill_ros.diagnosis.loading.law_place import place_of
from doormill_ros.diagnosis.loading.law_terms import law_terms
from doormill_ros.diagnosis.loading.other_words import in_other_words, less
from doormill_ros.diagnosis.loading.problem import LoadingDiagnosis, LoadingProblem
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause

#: Why a name is taken back.
NEEDLESS = "laws without a name elsewhere do as well"


class _BesideLaws(FittedQuestion[LoadingProblem, ElasticCause]):
    """A loading test, asked from a model with laws on."""

    def __init__(self, problem: LoadingProblem, laws: Fit[ElasticCause]) -> None:
        """Keep the model from which to set out."""
        super().__init__(problem)
        self._laws = laws

    def search(self, progress: Callable[[str], None]) -> Fit[ElasticCause]:
        """Laws may leave for causes, and causes for laws."""
        causes, terms = self.problem.candidates(), _unnamed(self._laws)
        models = BeamSearch(self.problem, [*causes, *terms])
        start = _in_names(models, models.fit(self._laws.members, [self._laws.theta]))
        # What a name says as well is no shape without one: it would stand against that name.
        self.models = BeamSearch(self.problem, [*causes, *_unnamed(start)], progress)
        self.models.largest = LawSearch.largest  # with room for the laws
        self.examiner = FitExaminer(self.problem, self.models, beside_laws=True)
        return _in_names(self.models, self.models.run([self.models.fit(start.members, [start.theta])]))


def _unnamed(model: Fit[ElasticCause]) -> list[ElasticCause]:
    return [member for member in model.members if not member.named]


def _in_names(models: BeamSearch[ElasticCause], model: Fit[ElasticCause]) -> Fit[ElasticCause]:
    """The model with a cause in the place of all that has no name there, wherever one says as much."""
    for where in dict.fromkeys(place_of(member).where for member in _unnamed(model)):
        rest = models.without(model, *(one for one in _unnamed(model) if place_of(one).where == where))
        named = [
            models.polished(models.add(rest, cause))
            for cause in models.candidates
            if cause.named and place_of(cause).where == where and may_join(rest.members, cause)
        ]
        for other in models.ranked(named)[:1]:
            if models.total(other) < models.total(model) + EQUAL:
                model = other
    return model


def asked_beside(
    diagnosis: LoadingDiagnosis,
    found: Characterised[ElasticCause],
    progress: Callable[[str], None] = lambda line: None,
) -> LoadingDiagnosis | None:
    """The diagnosis with names that stand beside laws; None where there are none but those that it has.

    Args:
        diagnosis: What was said before there were laws.
        found: The laws.
        progress: Told of every step.
    """
    problem = diagnosis.problem
    if excess_probability(found.fit, problem.components) < STRUCTURE:
        return None
    progress("asking for causes again beside the laws")
    question = _BesideLaws(problem, found.fit)
    again = told(question, judge_question(question, progress))
    before, now = _keys(diagnosis), _keys(again)
    more = question.at_noise(again.best) and before < now
    return again if more else None


def needless(
    diagnosis: LoadingDiagnosis, known: Collection[tuple[str, str]], progress: Callable[[str], None]
) -> list[ElasticCause]:
    """Named causes that the best laws elsewhere do without; none that was named before there were laws.

    Args:
        diagnosis: Causes, and laws beside them.
        known: Names and places of those that were named before.
        progress: Told of every step.
    """
    found = diagnosis.characterised
    if found is None:
        return []
    named = [finding for finding in diagnosis.findings if finding.cause.key not in known]
    return [finding.cause for finding in named if _behind(diagnosis, found.fit, finding, progress) < ENTRY]


def _behind(
    diagnosis: LoadingDiagnosis,
    told_by: Fit[ElasticCause],
    finding: Finding[ElasticCause],
    progress: Callable[[str], None],
) -> float:
    """By how much the score of the best laws elsewhere is larger than that with a cause."""
    problem, extended, cause = diagnosis.problem, diagnosis.extended, finding.cause
    progress(f"{cause!r} against laws alone")
    terms, _ = law_terms(diagnosis)
    own = LawSearch(problem, extended.members, extended.theta, terms, place_of).total(told_by)
    equal, where = {other.key for other in finding.confusable}, place_of(cause).where
    # What acts at its place, or does the same, says the same in other words and was asked before.
    same = in_other_words(problem, told_by, cause, terms)
    rivals = [
        term for term in terms if term.key not in equal and place_of(term).where != where and term not in same
    ]
    search = LawSearch(problem, *less(extended, cause), rivals, place_of)
    return search.total(search.run()) - own


def _keys(diagnosis: LoadingDiagnosis) -> set[tuple[str, str]]:
    return {cause.key for cause in diagnosis.examination.named}
