"""Laws without a name in series of poses: frames that are displaced beyond what the established causes say."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.characterised import Characterised
from doormill_ros.diagnosis.core.fit import Fit
from doormill_ros.diagnosis.law.characterise import remains
from doormill_ros.diagnosis.law.linear import LinearProblem, established
from doormill_ros.diagnosis.law.remainder import laws_for
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis
from doormill_ros.diagnosis.pose.fit import BLOCKS
from doormill_ros.diagnosis.pose.problem import PoseProblem
from doormill_ros.robot_model.pose.chain import derivatives
from doormill_ros.robot_model.pose.law.dictionary import dictionary
from doormill_ros.robot_model.pose.law.term import PoseTerm, Sight
from doormill_ros.robot_model.pose.model import PoseModel

#: Poses that are searched, at most.
POSES = 700


class PositionProblem(LinearProblem):
    """Fitted to positions and rotations, told, as all poses are, by the length of the position error."""

    def white(self, found: Fit[PoseTerm]) -> FloatArray:
        """Of the position alone, in standard deviations, shape (n, 3)."""
        return np.asarray(found.held_out / (np.sqrt(self.components) * self.sigma[:3]), dtype=float)

    def measured_part(self, white: FloatArray) -> FloatArray:
        """The position error, shape (n, 3), sized so that its mean square over all components is that of its length."""
        return np.asarray(np.sqrt(self.components) * (white * self.sigma)[:, :3], dtype=float)


def with_laws(diagnosis: PoseDiagnosis, progress: Callable[[str], None] = lambda line: None) -> PoseDiagnosis:
    """The diagnosis with laws for what its causes leave."""
    return replace(diagnosis, laws=_laws(diagnosis, progress)) if remains(diagnosis.verdict) else diagnosis


def _laws(diagnosis: PoseDiagnosis, progress: Callable[[str], None]) -> Characterised[PoseTerm] | None:
    model, problem = diagnosis.extended, diagnosis.extended.problem
    count = len(problem.sets)
    step = -(-sum(map(len, problem.sets)) // POSES)
    axes = 6 if all(one.oriented for one in problem.sets) else 3
    D = [derivatives(problem.frames(i)[::step], problem.placements[i])[:, :, :axes] for i in range(count)]
    sight = Sight(tuple(view.every(step) for view in problem.views), tuple(D))
    sigma = np.repeat(np.max([one.noise for one in problem.sets], axis=0), 3)[:axes]
    causes = problem.layout.size
    reach = np.concatenate(
        [np.sqrt(model.solution.variance[:causes]), np.full(problem.size - causes, np.inf)]
    )
    used = np.concatenate([model.ids(model.members), np.arange(causes, problem.size)]).astype(int)
    columns = np.concatenate([_columns(problem, i, step, part) for i, part in enumerate(D)])[:, :, used]
    block = [i * BLOCKS + np.arange(len(one)) * BLOCKS // len(one) for i, one in enumerate(problem.sets)]
    remainder = PositionProblem(
        np.concatenate([problem.residual(i)[::step, :axes] for i in range(count)]),
        sigma,
        sight,
        np.concatenate([one[::step] for one in block]),
        diagnosis.noise_floor,
        rows=np.flatnonzero(np.concatenate([~gross[::step] for gross in diagnosis.gross])),
    )
    base = established(columns, sigma, reach[used])
    return laws_for(remainder, base, dictionary(sight), progress)


def model_with_laws(diagnosis: PoseDiagnosis) -> PoseModel:
    """The established causes, fitted anew beside the laws, and those of these that hold beyond their series."""
    found, model = diagnosis.laws, diagnosis.model
    if found is None:
        return model
    problem, members = diagnosis.extended.problem, diagnosis.extended.members
    layout = problem.layout
    step = np.zeros(layout.size)
    ids = diagnosis.extended.ids(members).astype(int)
    base, *_ = found.fit.members
    step[ids] = found.weights(base)[: len(ids)]
    at = [np.arange(layout.size)[layout.part(layout.causes.index(cause))] for cause in model.causes]
    x = model.x + np.concatenate([np.zeros(0), *(step[part] for part in at)])
    terms = [term for law in found.laws for term in law.terms if term.lasts]
    return replace(model, x=x, laws=tuple((term, found.weights(term)) for term in terms))


def _columns(problem: PoseProblem, series: int, step: int, D: FloatArray) -> FloatArray:
    """Displacement of every so many-th pose of a series for a unit of every unknown, shape (m, axes, size)."""
    found = np.zeros((len(D), D.shape[2], problem.size))
    for direction, (ids, basis) in problem.bases[series].items():
        found[:, :, ids] += D[:, direction, :, None] * basis[::step, None, :]
    found[:, :, problem.placement_ids(series)] = np.swapaxes(D[:, problem.free[series]], 1, 2)
    return found
