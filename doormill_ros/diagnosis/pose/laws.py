"""Laws without a name in series of poses: frames that are displaced beyond what the established causes say."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.fit import Fit, fit
from doormill_ros.diagnosis.core.fitting.price import price_of_number
from doormill_ros.diagnosis.core.fitting.ranking import ranks
from doormill_ros.diagnosis.core.judgement import less
from doormill_ros.diagnosis.core.searching.beam import ENTRY
from doormill_ros.diagnosis.core.telling.characterised import Characterised
from doormill_ros.diagnosis.core.words.verdict import AT_NOISE, rmse
from doormill_ros.diagnosis.law.characterise import remains
from doormill_ros.diagnosis.law.linear import Established, LinearProblem, established
from doormill_ros.diagnosis.law.numbers import numbers_beside
from doormill_ros.diagnosis.law.remainder import searched
from doormill_ros.diagnosis.pose.beside_laws import asked_beside, with_reasons
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis
from doormill_ros.diagnosis.pose.fitting.fit import BLOCKS
from doormill_ros.diagnosis.pose.fitting.noise import common_noise, evening
from doormill_ros.diagnosis.pose.fitting.problem import PoseProblem
from doormill_ros.robot_model.pose.causes.cause import CLEAR, PoseCause
from doormill_ros.robot_model.pose.chain import Placement, derivatives
from doormill_ros.robot_model.pose.law.dictionary import dictionary
from doormill_ros.robot_model.pose.law.term import PoseTerm, Sight
from doormill_ros.robot_model.pose.model import PoseModel

#: Why a cause is not named that a law does without.
NEEDLESS = "beside a law without a name nothing calls for it"
GONE = "beside a law without a name no such size is left of it"
SHARED = (
    "a law elsewhere follows the angle of this joint, and with one here as well nothing calls for the name"
)
#: Of the residual, up to which one explanation predicts as well as another.
SAME = 1.01
#: Times the noise that laws may leave for causes to be asked beside them.
DESCRIBED = 2.0
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
    """The diagnosis with laws for what its causes leave, and with causes that these had hidden.

    A cause that stands only beside laws is named where they and all causes together leave no more than noise.
    """
    told = _with_laws(diagnosis, progress)
    if told.laws is None or told.laws.holdout_rmse > DESCRIBED * diagnosis.noise_floor:
        return told
    every = [term for law in told.laws.laws for term in law.terms]
    first = told.laws.laws[0].terms  # the others may be what a cause hides behind
    for terms in [every, first][: len(told.laws.laws)]:
        asked = asked_beside(diagnosis, terms, progress)
        if not _names_more(asked, told):
            continue
        again = _with_laws(asked, progress)
        quiet = again.laws is not None and again.laws.holdout_rmse <= AT_NOISE * again.noise_floor
        if quiet and _names_more(again, told):
            return with_reasons(again, told)
    return told


def _names_more(one: PoseDiagnosis, other: PoseDiagnosis) -> bool:
    """Whether a diagnosis names all that another one does, and more."""
    more, known = ({cause.key for cause in each.examination.named} for each in (one, other))
    return known < more


def _with_laws(diagnosis: PoseDiagnosis, progress: Callable[[str], None]) -> PoseDiagnosis:
    """The diagnosis with laws for what its causes leave, and without causes that only stood for a law."""
    if not remains(diagnosis.verdict):
        return diagnosis
    found = _searched(diagnosis, progress)
    needless = [] if found is None else _needless(diagnosis, found)
    if needless:
        progress(f"beside a law nothing calls for {', '.join(map(repr, needless))}")
        diagnosis = _less(diagnosis, needless, NEEDLESS)
        found = _searched(diagnosis, progress)
    diagnosis = replace(diagnosis, laws=found)
    if found is None:
        return diagnosis
    if gone := _gone(diagnosis):
        progress(f"beside a law nothing is left of {', '.join(map(repr, gone))}")
        return _with_laws(_less(diagnosis, gone, GONE), progress)
    if not (shared := _shared(diagnosis, found)):
        return diagnosis
    progress(
        f"a law follows the angle of the joint of {', '.join(map(repr, shared))}; asking laws without it"
    )
    alone = _with_laws(_less(diagnosis, shared, SHARED), progress)
    as_good = alone.laws is not None and alone.laws.holdout_rmse <= SAME * found.holdout_rmse
    return alone if as_good else diagnosis


def _less(diagnosis: PoseDiagnosis, causes: Sequence[PoseCause], why: str) -> PoseDiagnosis:
    """The same without some names, weighed anew and without laws."""
    question = diagnosis.question
    return PoseDiagnosis(**vars(less(question, diagnosis, causes, why)), question=question)


def _gone(diagnosis: PoseDiagnosis) -> list[PoseCause]:
    """Named causes of which no number is clear of zero beside the laws, or that would have to push back."""
    beside, std = numbers_told(diagnosis)
    named = diagnosis.examination.named
    parts = [(cause, beside.x[part], std[part]) for cause, part in diagnosis.extended.parts if cause in named]
    return [cause for cause, x, own in parts if not np.any(np.abs(x) > CLEAR * own) or cause.impossible(x)]


def _shared(diagnosis: PoseDiagnosis, found: Characterised[PoseTerm]) -> list[PoseCause]:
    """Named causes whose driver also drives a law elsewhere, where more than noise remains.

    Turns of two parallel joints by one angle are a displacement nearly: together they may stand for a third thing.
    """
    if found.holdout_rmse <= AT_NOISE * diagnosis.noise_floor:
        return []
    driving = {law.driver for law in found.laws}
    return [cause for cause in diagnosis.examination.named if cause.driver_elsewhere in driving]


def numbers_told(diagnosis: PoseDiagnosis) -> tuple[PoseProblem, FloatArray]:
    """The extended fit with the numbers that are told of it, those beside the laws where there are any.

    Returns:
        The fit, and the standard deviation of every coefficient, shape (m,).
    """
    found, fit = diagnosis.laws, diagnosis.extended
    if found is None:
        return fit.problem, diagnosis.std
    assert isinstance(found.problem, LinearProblem)
    values, deviation = numbers_beside(found.problem, found.fit)
    x = np.concatenate([fit.problem.x, np.zeros(fit.problem.size - fit.problem.layout.size)])
    std = np.zeros(fit.problem.size)
    used = _used(fit.problem, fit.ids(fit.members))
    # The remainder is what the fit leaves: laws move its numbers.
    x[used] += values
    std[used] = deviation
    return fit.problem.at(x), std[: fit.problem.layout.size]


def _searched(diagnosis: PoseDiagnosis, progress: Callable[[str], None]) -> Characterised[PoseTerm] | None:
    problem, base = _remainder(diagnosis)
    return searched(problem, base, dictionary(problem.case), progress).told


def _needless(diagnosis: PoseDiagnosis, found: Characterised[PoseTerm]) -> list[PoseCause]:
    """Named causes that the laws do without, the least useful first, where what then remains is no more than noise.

    Beside a remainder that nothing explains no such thing can be said. A cause that is out of place spoils rows left
    out, so that it is the model without it that has to reach the noise.
    """
    terms = [term for law in found.laws for term in law.terms]

    def asked(without: Sequence[PoseCause]) -> tuple[float, float]:
        """Score and held-out error less some causes."""
        problem, base = _remainder(diagnosis, without)
        each = price_of_number(problem.components * len(problem))
        less = fit(problem, (base, *terms))
        left = rmse(less.held_out, np.ones(len(problem), dtype=bool), problem.components)
        return float(less.held_out_score + each * base.size), left

    needless: list[PoseCause] = []
    now, left = asked(())
    while rest := [cause for cause in diagnosis.examination.named if cause not in needless]:
        tried = [asked((*needless, cause)) for cause in rest]
        least = int(ranks(np.array([score for score, _ in tried]))[0])
        if tried[least][0] - now >= ENTRY:
            break
        needless.append(rest[least])
        now, left = tried[least]
    return needless if left <= AT_NOISE * diagnosis.noise_floor else []


def _remainder(
    diagnosis: PoseDiagnosis, without: Sequence[PoseCause] = ()
) -> tuple[PositionProblem, Established]:
    """What is left to explain, and what the established causes less some say of it, both at the common noise."""
    model, problem = diagnosis.extended, diagnosis.extended.problem
    members = [cause for cause in model.members if cause not in without]
    count = len(problem.sets)
    step = -(-sum(map(len, problem.sets)) // POSES)
    axes = 6 if all(one.oriented for one in problem.sets) else 3
    ids = model.ids(members).astype(int)
    x = np.zeros(problem.layout.size)
    x[ids] = problem.x[ids]
    even = [factor[:axes] for factor in evening(problem.sets)]
    D = [
        even[i] * derivatives(problem.frames(i, x)[::step], problem.placements[i])[:, :, :axes]
        for i in range(count)
    ]
    sight = Sight(tuple(view.every(step) for view in problem.views), tuple(D))
    sigma = np.repeat(common_noise(problem.sets), 3)[:axes]
    causes = problem.layout.size
    reach = np.concatenate(
        [np.sqrt(model.solution.variance[:causes]), np.full(problem.size - causes, np.inf)]
    )
    used = _used(problem, ids)
    columns = np.concatenate([_columns(problem, i, step, part) for i, part in enumerate(D)])[:, :, used]
    block = [i * BLOCKS + np.arange(len(one)) * BLOCKS // len(one) for i, one in enumerate(problem.sets)]
    remainder = PositionProblem(
        np.concatenate([even[i] * problem.residual(i, x)[::step, :axes] for i in range(count)]),
        sigma,
        sight,
        np.concatenate([one[::step] for one in block]),
        diagnosis.noise_floor,
        rows=np.flatnonzero(np.concatenate([~gross[::step] for gross in diagnosis.gross])),
    )
    base = established(columns, sigma, reach[used])
    return remainder, base


def model_with_laws(diagnosis: PoseDiagnosis) -> PoseModel:
    """The established causes, fitted anew beside the laws, and those of these that hold beyond their series."""
    found, model = diagnosis.laws, diagnosis.model
    if found is None:
        return model
    x = numbers_told(diagnosis)[0].x[diagnosis.extended.ids(model.causes).astype(int)]
    terms = [term for law in found.laws for term in law.terms if term.lasts]
    return replace(model, x=x, laws=tuple((term, found.weights(term)) for term in terms))


def _columns(problem: PoseProblem, series: int, step: int, D: FloatArray) -> FloatArray:
    """Displacement of every so many-th pose of a series for a unit of every unknown, shape (m, axes, size)."""
    found = np.zeros((len(D), D.shape[2], problem.size))
    for direction, (ids, basis) in problem.bases[series].items():
        found[:, :, ids] += D[:, direction, :, None] * basis[::step, None, :]
    found[:, :, problem.placement_ids(series)] = np.swapaxes(D[:, problem.free[series]], 1, 2)
    return found


def placements_with_laws(diagnosis: PoseDiagnosis) -> list[Placement]:
    """Placement of every series, fitted anew beside the laws as well."""
    return numbers_told(diagnosis)[0].placements


def _used(problem: PoseProblem, ids: IntArray) -> IntArray:
    """Coefficients of some causes, shape (k,), and all placements'."""
    return np.concatenate([ids.astype(int), np.arange(problem.layout.size, problem.size)])
