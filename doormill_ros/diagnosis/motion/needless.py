"""Names that a joint's laws take back: a law of the cause's own driver beside it, or one that does without the cause.

A cause may have stood for a part of a law before there was one: play for a spring that softens, a spring for friction
in one place. Beside a remainder that no law explains nothing of that kind can be said.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.fitting.ranking import ranks
from doormill_ros.diagnosis.core.searching.beam import EQUAL
from doormill_ros.diagnosis.core.words.verdict import AT_NOISE
from doormill_ros.diagnosis.law.linear import LinearProblem
from doormill_ros.diagnosis.law.remainder import Searched, searched_once
from doormill_ros.diagnosis.motion.examination import JointFinding
from doormill_ros.diagnosis.motion.remainder import Companies, beside_laws, remainder
from doormill_ros.diagnosis.motion.search import CLEAR, WORTH
from doormill_ros.robot_model.motion.causes.cause import SPRING, MotionCause
from doormill_ros.robot_model.motion.law.dictionary import dictionary
from doormill_ros.robot_model.motion.law.term import MotionTerm
from doormill_ros.statistics import root_mean_square

#: Why a name is taken back.
OTHER_LAW = "what follows the same driver beside it says that its law is another"
NEEDLESS = "a law without a name does as well without it"
GONE = "beside a law without a name no such size is left of it"
#: Driver that is no reading of the one before its bracket.
CHANGE = "speed (its change)"
#: What a spring or a gap acts on in the words of laws, and a damper.
_ACTS_ON = (SPRING, "joint angle")
#: Share of a cause's effect that one other term follows to be the same in other words, too.
_SAME = 0.95


def taken_back(
    finding: JointFinding,
    companies: Companies,
    found: Searched,
    progress: Callable[[str], None] = lambda line: None,
) -> list[tuple[MotionCause, str]]:
    """Named causes of a joint that cannot keep their names beside its laws, each with the reason.

    Args:
        finding: The joint.
        companies: All joints of each recording.
        found: Laws beside all named causes.
        progress: Told of every step.
    """
    if explains(finding, found.best):
        other = [cause for cause in finding.named if any(_same_law(term, cause) for term in found.laws)]
        if other:
            return [(cause, OTHER_LAW) for cause in other]
    behind = [_behind(finding, companies, found, cause, progress) for cause in finding.named]
    if not behind:
        return []
    least = int(ranks(np.array(behind))[0])
    if behind[least] < EQUAL:
        return [(finding.named[least], NEEDLESS)]
    gone = size_gone(finding, found)
    return [] if gone is None else [(gone, GONE)]


def size_gone(finding: JointFinding, found: Searched) -> MotionCause | None:
    """The named cause of which least is left beside laws, if that is not clear of zero or what no such cause can be."""
    if not (found.laws and finding.named):
        return None
    told = beside_laws(finding.problem, finding.extended, found.problem, found.best)
    impossible = finding.problem.impossible(told)
    strengths = [
        -1.0 if any(cause is one for one in impossible) else finding.search.strength(told, cause)
        for cause in finding.named
    ]
    least = int(ranks(np.array(strengths))[0])
    return finding.named[least] if strengths[least] <= CLEAR else None


def _same_law(term: MotionTerm, cause: MotionCause) -> bool:
    """Whether a term says of a cause that its law is another."""
    # How a speed changes is no other law of the speed.
    driver = term.driver if term.driver == CHANGE else term.driver.partition(" (")[0]
    return term.acts_on in _ACTS_ON and driver in cause.follows


def acts_alike(term: MotionTerm, cause: MotionCause) -> bool:
    """Whether a term acts on what a cause acts on."""
    return bool(cause.acts_on) and term.acts_on.startswith(cause.acts_on)


def explains(finding: JointFinding, model: Fit[MotionTerm]) -> bool:
    """Whether what laws leave is noise, or less than what the least cause has to be worth."""
    floor, before = finding.problem.floor, finding.problem.rmse(finding.extended.held_out)
    left = root_mean_square(model.held_out)
    return left <= AT_NOISE * floor or left**2 - floor**2 < WORTH * (before**2 - floor**2)


def _behind(
    finding: JointFinding,
    companies: Companies,
    found: Searched,
    cause: MotionCause,
    progress: Callable[[str], None],
) -> float:
    """By how much the score is larger of the best laws without a cause; infinite where these explain little."""
    extended = finding.extended
    rest = [other for other in extended.members if other is not cause]
    delay = finding.search.delay_without(extended.delay, cause)
    rows = finding.problem.counted(extended.delay)
    problem, base = remainder(finding.problem, rest, delay, companies, rows)
    terms = [
        term
        for term in not_the_same(finding, problem, [cause], law_terms(finding, problem, rest, delay))
        # A friction that varies is a friction still.
        if not acts_alike(term, cause)
    ]
    problem = problem.coarser(float(found.problem.sigma[0] / problem.sigma[0]))
    progress(f"{cause!r} against laws alone")
    rival = searched_once(problem, base, terms, progress)
    return rival.total - found.total if explains(finding, rival.best) else float("inf")


def law_terms(
    finding: JointFinding, problem: LinearProblem, members: Sequence[MotionCause], delay: float
) -> list[MotionTerm]:
    """Every term that may say what some causes of a joint leave at a delay [s].

    Of the acceleration those alone that an inertia or the lag of a filter on the link's encoder could leave: it is a
    part of each torque, and takes the place of other laws of it otherwise.
    """
    free, _ = np.linalg.qr(problem.of_rows(finding.problem.design(members, delay)))
    left = problem.target[:, 0] - free @ (free.T @ problem.target[:, 0])
    return [
        term
        for term in dictionary(problem.case)
        if term.driver != CHANGE or float(left @ problem.effect(term)[:, 0, 0]) > 0.0
    ]


def not_the_same(
    finding: JointFinding, problem: LinearProblem, causes: Sequence[MotionCause], terms: Sequence[MotionTerm]
) -> list[MotionTerm]:
    """Terms that say of none of some named causes the same in other words: beside them neither would have a size.

    Args:
        finding: The joint.
        problem: What is left to explain in it.
        causes: Those of its named causes.
        terms: What may join.
    """
    delay = finding.extended.delay
    offsets = problem.of_rows(finding.problem.design([], delay))
    effects = [problem.of_rows(_effect(finding, cause)) for cause in causes]
    return [
        term
        for term in terms
        if all(_followed(effect, problem.effect(term)[:, 0], offsets) < _SAME for effect in effects)
    ]


def _effect(finding: JointFinding, cause: MotionCause) -> FloatArray:
    """What a cause leaves in a model, shape (n,), in a unit of its own."""
    extended = finding.extended
    index = extended.members.index(cause)
    shared, own = finding.problem.columns_of(cause, extended.delay)
    # A skew is about the delay at which the joint is seen: its own number is next to nothing.
    x = np.ones(1) if cause.of_delay else extended.x[index]
    parts = zip(shared, own, extended.own[index], strict=True)
    return np.concatenate([one @ x + mine @ y for one, mine, y in parts])


def _followed(effect: FloatArray, term: FloatArray, offsets: FloatArray) -> float:
    """Share of an effect, shape (n,), that columns of a term, shape (n, m), follow beside offsets, shape (n, r)."""
    free, _ = np.linalg.qr(offsets)
    asked, other = (part - free @ (free.T @ part) for part in (effect, term))
    basis, _ = np.linalg.qr(other)
    return float(np.sum((basis.T @ asked) ** 2) / max(float(np.sum(asked**2)), 1e-300))
