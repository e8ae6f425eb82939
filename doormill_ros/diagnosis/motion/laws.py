"""Laws without a name in moving joints: each joint whose causes leave something is searched by itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from doormill_ros.diagnosis.core.judgement import weighed
from doormill_ros.diagnosis.law.characterise import remains
from doormill_ros.diagnosis.law.remainder import Searched, searched
from doormill_ros.diagnosis.motion.diagnosis import MotionDiagnosis
from doormill_ros.diagnosis.motion.examination import JointFinding
from doormill_ros.diagnosis.motion.model import model_of
from doormill_ros.diagnosis.motion.needless import (
    acts_alike,
    explains,
    law_terms,
    not_the_same,
    size_gone,
    taken_back,
)
from doormill_ros.diagnosis.motion.remainder import Companies, remainder
from doormill_ros.robot_model.motion.model import MotionModel


def with_laws(
    diagnosis: MotionDiagnosis, progress: Callable[[str], None] = lambda line: None
) -> MotionDiagnosis:
    """The diagnosis with laws for what its causes leave, and without names that these take back."""
    if not remains(diagnosis.verdict):
        return diagnosis
    companies = [one.motions for one in diagnosis.sets]
    found = [_searched(one, companies, progress) if _open(one) else None for one in diagnosis.joints]
    back = [
        [] if laws is None else taken_back(one, companies, laws, progress)
        for one, laws in zip(diagnosis.joints, found, strict=True)
    ]
    if any(back):
        progress(f"beside laws no name for {', '.join(repr(cause) for part in back for cause, _ in part)}")
        question = diagnosis.question
        fewer = question.less(diagnosis.examination, back)
        return with_laws(
            MotionDiagnosis(**vars(weighed(question, fewer, stays=True)), question=question), progress
        )
    return replace(diagnosis, laws=tuple(None if laws is None else laws.told for laws in found))


def _searched(finding: JointFinding, companies: Companies, progress: Callable[[str], None]) -> Searched:
    """Laws for what the causes of a joint leave."""
    extended = finding.extended
    rows = finding.problem.counted(extended.delay)
    problem, base = remainder(finding.problem, extended.members, extended.delay, companies, rows)
    every = law_terms(finding, problem, extended.members, extended.delay)
    terms = not_the_same(finding, problem, finding.named, every)
    found = searched(problem, base, terms, progress)
    # Several terms together may say the same as a cause: those that leave more than noise cannot do without it either.
    while not explains(finding, found.best) and (gone := size_gone(finding, found)) is not None:
        beside = [term for term in terms if not acts_alike(term, gone)]
        if len(beside) == len(terms):
            break
        progress(f"laws that leave {gone!r} its size")
        terms = beside
        found = searched(problem, base, terms, progress)
    return found


def model_with_laws(diagnosis: MotionDiagnosis) -> MotionModel:
    """The established causes, fitted anew beside the laws of their joint, and these."""
    joints = []
    for finding, told, found in zip(diagnosis.joints, diagnosis.told, diagnosis.laws, strict=True):
        terms = (
            [] if found is None else [(term, found.weights(term)) for law in found.laws for term in law.terms]
        )
        joints.append(replace(model_of(told, finding.problem.motions[0]), laws=tuple(terms)))
    return MotionModel(diagnosis.sets[0].robot, tuple(joints))


def _open(finding: JointFinding) -> bool:
    """Whether the named causes of a joint leave anything."""
    whole = all(cause.named for cause in finding.best.members) and not finding.refused
    return not whole or finding.examiner.remains(finding.extended)
