"""What some causes of a joint leave, ready for a search over laws."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import IntArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.words.wording import RADIANS
from doormill_ros.diagnosis.law.linear import Established, LinearProblem, established
from doormill_ros.diagnosis.law.numbers import numbers_beside
from doormill_ros.diagnosis.motion.model import JointFit
from doormill_ros.diagnosis.motion.problem import JointProblem
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.law.ride import ride_of
from doormill_ros.robot_model.motion.law.term import MotionTerm
from doormill_ros.robot_model.motion.view import JointMotion

#: All joints of each recording.
Companies = Sequence[Sequence[JointMotion]]


def remainder(
    problem: JointProblem,
    members: Sequence[MotionCause],
    delay: float,
    companies: Companies,
    rows: IntArray,
) -> tuple[LinearProblem, Established]:
    """What is left to explain beside some causes of a joint, which stay.

    Args:
        problem: The joint.
        members: The causes.
        delay: At which the joint is seen [s].
        companies: All joints of each recording.
        rows: Samples that count, shape (m,).
    """
    rides = tuple(
        ride_of(motion, company, delay) for motion, company in zip(problem.motions, companies, strict=True)
    )
    sigma = np.array([problem.floor])
    columns = problem.design(members, delay)[:, None, :]
    base = established(columns, sigma, np.full(columns.shape[2], np.inf))
    target = problem.target(delay)[:, None]
    return LinearProblem(target, sigma, rides, problem.block, problem.floor, RADIANS, rows), base


def beside_laws(
    problem: JointProblem, extended: JointFit, left: LinearProblem, found: Fit[MotionTerm]
) -> JointFit:
    """The causes of a joint with the numbers that they have beside laws; what it leaves is not told, but empty.

    Args:
        problem: The joint.
        extended: The causes as fitted alone.
        left: What was left to explain.
        found: The model with laws.
    """
    values, std = numbers_beside(left, found)
    none = np.zeros(0)
    return problem.unpacked(extended.members, extended.delay, values, std, none, none)
