"""Laws without a name in moving joints: each joint whose causes leave something is searched by itself."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from doormill_ros.diagnosis.core.characterised import Characterised
from doormill_ros.diagnosis.core.wording import RADIANS
from doormill_ros.diagnosis.law.characterise import remains
from doormill_ros.diagnosis.law.linear import LinearProblem, established
from doormill_ros.diagnosis.law.remainder import laws_for
from doormill_ros.diagnosis.motion.diagnosis import MotionDiagnosis
from doormill_ros.diagnosis.motion.examination import JointFinding
from doormill_ros.diagnosis.motion.model import model_of
from doormill_ros.robot_model.motion.law.dictionary import dictionary
from doormill_ros.robot_model.motion.law.ride import ride_of
from doormill_ros.robot_model.motion.law.term import MotionTerm
from doormill_ros.robot_model.motion.model import MotionModel
from doormill_ros.robot_model.motion.view import JointMotion

#: Samples that are searched, at most: the others repeat them.
SAMPLES = 3000


def laws_of(
    finding: JointFinding,
    companies: Sequence[Sequence[JointMotion]],
    progress: Callable[[str], None] = lambda line: None,
) -> Characterised[MotionTerm] | None:
    """Laws for what the causes of a joint leave; None where nothing can be said.

    Args:
        finding: The joint.
        companies: All joints of each recording.
        progress: Told of every step.
    """
    problem, extended = finding.problem, finding.extended
    rides = tuple(
        ride_of(motion, company, extended.delay)
        for motion, company in zip(problem.motions, companies, strict=True)
    )
    rows = np.flatnonzero(problem.kept)
    rows = rows[:: -(-len(rows) // SAMPLES)]
    sigma = np.array([problem.floor])
    columns = problem.design(extended.members, extended.delay)[:, None, :]
    base = established(columns, sigma, np.full(columns.shape[2], np.inf))
    target = problem.target(extended.delay)[:, None]
    remainder = LinearProblem(target, sigma, rides, problem.block, problem.floor, RADIANS, rows)
    return laws_for(remainder, base, dictionary(rides), progress)


def with_laws(
    diagnosis: MotionDiagnosis, progress: Callable[[str], None] = lambda line: None
) -> MotionDiagnosis:
    """The diagnosis with laws for what its causes leave."""
    if not remains(diagnosis.verdict):
        return diagnosis
    companies = [one.motions for one in diagnosis.sets]
    found = [laws_of(one, companies, progress) if _open(one) else None for one in diagnosis.joints]
    return replace(diagnosis, laws=tuple(found))


def model_with_laws(diagnosis: MotionDiagnosis) -> MotionModel:
    """The established causes, fitted anew beside the laws of their joint, and these."""
    joints = []
    for finding, found in zip(diagnosis.joints, diagnosis.laws, strict=True):
        extended, problem, motion = finding.extended, finding.problem, finding.problem.motions[0]
        if found is not None:
            base, *_ = found.fit.members
            none = np.zeros(0)
            solution = found.weights(base)
            beside = problem.unpacked(extended.members, extended.delay, solution, 0.0 * solution, none, none)
            laws = [(term, found.weights(term)) for law in found.laws for term in law.terms]
            joints.append(replace(model_of(beside, motion), laws=tuple(laws)))
        else:
            joints.append(model_of(extended, motion))
    return MotionModel(diagnosis.sets[0].robot, tuple(joints))


def _open(finding: JointFinding) -> bool:
    """Whether the named causes of a joint leave anything."""
    whole = all(cause.named for cause in finding.best.members) and not finding.refused
    return not whole or finding.examiner.remains(finding.extended)
