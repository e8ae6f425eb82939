"""What may be a part of a law without a name in a loading test."""

from __future__ import annotations

from doormill_ros.diagnosis.law.labels import without_labels
from doormill_ros.diagnosis.loading.problem import LoadingDiagnosis
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.elastic.causes.registry import candidates
from doormill_ros.robot_model.elastic.law.dictionary import dictionary


def law_terms(diagnosis: LoadingDiagnosis) -> tuple[list[ElasticCause], tuple[str, ...]]:
    """What may join the established causes, and the drivers that only number the postures."""
    problem = diagnosis.problem
    reflectors = list(dict.fromkeys(problem.data.reflector.tolist()))
    # A cause that is not believed may still be a part of a law; one with a kink has many valleys, the dictionary none.
    known = [cause for cause in candidates(reflectors) if problem.allowed(cause) and not cause.kinked]
    keys = {cause.key for cause in diagnosis.extended.members}
    laws, labels = without_labels(dictionary(problem.case, reflectors), problem.case, problem.configuration)
    return [term for term in (*known, *laws) if term.key not in keys], labels
