"""Laws without a name in a loading test: the terms that its trials can speak of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from doormill_ros.diagnosis.core.examining.finding import make_findings
from doormill_ros.diagnosis.core.examining.fit_examiner import STRUCTURE, excess_probability
from doormill_ros.diagnosis.core.kind import Progress
from doormill_ros.diagnosis.core.telling.characterised import Characterised
from doormill_ros.diagnosis.core.words.verdict import AT_NOISE
from doormill_ros.diagnosis.law.characterise import characterise, remains
from doormill_ros.diagnosis.law.labels import not_tried
from doormill_ros.diagnosis.law.search import LawSearch
from doormill_ros.diagnosis.loading.beside_laws import NEEDLESS, asked_beside, needless
from doormill_ros.diagnosis.loading.law_place import place_of
from doormill_ros.diagnosis.loading.law_terms import law_terms
from doormill_ros.diagnosis.loading.other_words import acts, in_other_words
from doormill_ros.diagnosis.loading.problem import LoadingDiagnosis
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.extended_model import SizedCause

#: Why a cause is not named that stands where a law acts.
MEAN_PART = "a law without a name acts at the same place, and it may be the mean of that"


def with_laws(
    diagnosis: LoadingDiagnosis, progress: Progress = lambda line: None, asked: bool = False
) -> LoadingDiagnosis:
    """The diagnosis with laws for what its causes leave, less names that these take back, and names found beside them.

    Args:
        diagnosis: What its causes say.
        progress: Told of every step.
        asked: Whether its names were asked for beside laws.
    """
    if not remains(diagnosis.verdict):
        return diagnosis
    problem, extended = diagnosis.problem, diagnosis.extended
    terms, labels = law_terms(diagnosis)
    search = LawSearch(problem, extended.members, extended.theta, terms, place_of, progress)
    found, why = characterise(search, diagnosis.kept)
    if found is not None and (parts := _mean_parts(diagnosis, found, terms)):
        progress(f"beside a law no name for {', '.join(map(repr, parts))}")
        return with_laws(diagnosis.less(parts, MEAN_PART), progress, asked)
    if found is not None and not asked and (again := asked_beside(diagnosis, found, progress)) is not None:
        known = {cause.key for cause in diagnosis.examination.named}
        more = with_laws(again, progress, asked=True)
        if back := needless(more, known, progress):
            progress(f"laws do without {', '.join(map(repr, back))}")
            more = with_laws(more.less(back, NEEDLESS), progress, asked=True)
        if more.characterised is not None and known < {cause.key for cause in more.examination.named}:
            return more
    remains_still = found is None or found.holdout_rmse >= AT_NOISE * problem.noise_floor
    remarks = [*([why] if why else []), *([not_tried(labels)] if labels and remains_still else [])]
    told = replace(diagnosis, characterised=found, remarks=(*diagnosis.remarks, *remarks))
    if found is None:
        return told
    # One model, one set of numbers: those of the fit that holds the laws, too.
    structure = excess_probability(found.fit, problem.components) < STRUCTURE
    return replace(
        told, findings=make_findings(diagnosis.search, diagnosis.examination, structure, found.fit)
    )


def _mean_parts(
    diagnosis: LoadingDiagnosis, found: Characterised[ElasticCause], terms: Sequence[ElasticCause]
) -> list[ElasticCause]:
    """Named causes at the place of a law, in whatever words, or at an end of its link.

    One with a kink is the mean of no law.
    """
    places = {law.where for law in found.laws}
    acting = {acts(term) for law in found.laws for term in law.terms}
    return [
        cause
        for cause in diagnosis.examination.named
        if not cause.kinked
        and (
            place_of(cause).where in places
            or not places.isdisjoint(cause.also_at)
            or not acting.isdisjoint(map(acts, in_other_words(diagnosis.problem, found.fit, cause, terms)))
        )
    ]


def sized_laws(diagnosis: LoadingDiagnosis) -> list[SizedCause]:
    """Every term of every law with its weights."""
    found = diagnosis.characterised
    if found is None:
        return []
    return [SizedCause(term, found.weights(term)) for law in found.laws for term in law.terms]


def law_sections(found: Characterised[ElasticCause] | None) -> dict[str, Any]:
    """What diagnosis.json says of laws; nothing where there are none."""
    return {} if found is None else found.document()
