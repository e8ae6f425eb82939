"""From series of poses to a verdict: what is wrong, how sure, what the extended model gains."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core import verdict
from doormill_ros.diagnosis.pose.fit import Fitted, deviation, fit_causes, place_nominally
from doormill_ros.diagnosis.pose.orders import find_orders
from doormill_ros.diagnosis.pose.selection import REAL, Score, eliminate, explained_cost, scores
from doormill_ros.diagnosis.pose.solve import add_up
from doormill_ros.diagnosis.pose.validation import Validation, by_block
from doormill_ros.measurements.errors import SetMixError
from doormill_ros.measurements.pose_set import PoseSet
from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.causes.hints import JOINTS, Hints
from doormill_ros.robot_model.pose.causes.joint_periodic_error import dense_orders
from doormill_ros.robot_model.pose.causes.registry import candidates
from doormill_ros.robot_model.pose.causes.session_step import find_step
from doormill_ros.robot_model.pose.model import PoseModel
from doormill_ros.statistics import bootstrap_ratio

#: Fall of the sum of squares that makes a step worth a trial.
STEP = 60.0
#: Held-out error over noise up to which a model explains everything.
AT_NOISE = 1.1
#: Share of the excess over the noise that causes have to explain to be named when structure remains.
MAIN_PART = 0.5


@dataclass(frozen=True, eq=False)
class Errors:
    """Residuals of every row of every series in base axes, shape (n, 6) each."""

    train: list[FloatArray]
    blocks: list[FloatArray]
    series: list[FloatArray]


@dataclass(frozen=True, eq=False)
class PoseDiagnosis:
    """Everything that a diagnosis of poses knows.

    Attributes:
        sets: The series.
        verdict: consistent, explained, partly_explained or unexplained.
        noise_floor: 3-D position error that the tracker's noise alone leaves [m].
        extended: Fit of the established causes.
        baseline: Fit of the placements alone.
        established: Scores of the established causes, gross errors aside.
        rejected: Scores of the others.
        std: Standard deviation of every coefficient of the extended fit.
        gross: Rows of every series that are gross errors, bool.
        before, after: Residuals of baseline and extended model.
        ratio, ratio_ci: Held-out error extended over baseline, and its 95 % interval.
        model: What holds for the robot itself.
    """

    sets: tuple[PoseSet, ...]
    verdict: str
    noise_floor: float
    extended: Fitted
    baseline: Fitted
    established: list[Score]
    rejected: list[Score]
    std: FloatArray
    gross: list[BoolArray]
    before: Errors
    after: Errors
    ratio: float
    ratio_ci: tuple[float, float]
    model: PoseModel


def check_together(sets: Sequence[PoseSet]) -> None:
    """Sets that are given together have to question the same model.

    Raises:
        SetMixError: They do not.
    """
    first = sets[0]
    for other in sets[1:]:
        for name, mine, theirs in (("robot", first.robot, other.robot), ("model.dh", first.dh, other.dh)):
            if not np.array_equal(mine, theirs):
                raise SetMixError(
                    f"{other.path / 'set.yaml'}: line 1, column 1: {name} is not the one in {first.path}; "
                    "sets given together need the same"
                )


def diagnose_poses(
    sets: Sequence[PoseSet], progress: Callable[[str], None] = lambda line: None
) -> PoseDiagnosis:
    """Question the nominal model of a robot with several series."""
    check_together(sets)
    rows = sum(len(data) for data in sets)
    progress(f"{rows} poses in {len(sets)} series; placing them under the nominal model")
    placements = place_nominally(sets)
    baseline = fit_causes(sets, (), placements, passes=2)
    fitted = _search(sets, baseline, progress)
    progress("leaving out blocks and whole series")
    validation = Validation(fitted)
    stay, gone = eliminate(validation, progress)
    while True:
        extended = _refit(sets, fitted, stay, progress)
        final = Validation(extended)
        stay = scores(final, range(len(stay)), explained_cost(final)) if stay else []
        # Noise and weights have changed with the weak causes gone: what is laid on the robot has to pass once more.
        fallen = [score for score in stay if score.cause.transfers and score.status != REAL]
        if not fallen:
            break
        gone += fallen
        fitted, stay = extended, [score for score in stay if score not in fallen]
    before = _errors(baseline, Validation(baseline))
    after = _errors(extended, final)
    gross = [weight == 0.0 for weight in extended.problem.weights]
    floor = float(np.sqrt(3.0) * max(data.noise[0] for data in sets))
    kept = [~bad for bad in gross]
    word = _verdict(rmse(before.blocks, kept), rmse(after.blocks, kept), floor, extended, before, bool(stay))
    if word in (verdict.UNEXPLAINED, verdict.CONSISTENT):
        gone, stay = stay + gone, []
        extended, after = baseline, before
        gross = [
            bad & (deviation(error, baseline.problem.sigma) > 5.0)
            for bad, error in zip(gross, before.train, strict=True)
        ]
        kept = [~bad for bad in gross]
    ratio, interval = _gain(before.blocks, after.blocks, kept)
    return PoseDiagnosis(
        sets=tuple(sets),
        verdict=word,
        noise_floor=floor,
        extended=extended,
        baseline=baseline,
        established=stay,
        rejected=gone,
        std=standard_deviations(extended),
        gross=gross,
        before=before,
        after=after,
        ratio=ratio,
        ratio_ci=interval,
        model=_model(extended),
    )


def _search(sets: Sequence[PoseSet], baseline: Fitted, progress: Callable[[str], None]) -> Fitted:
    """Fit of everything that may act: first without, then with hints from the residual."""
    views = [data.view for data in sets]
    dense = dense_orders(views)
    library = candidates(Hints(views, dict.fromkeys(JOINTS, dense), drift=False))
    progress(f"{len(library)} causes to try")
    first = fit_causes(sets, library, baseline.problem.placements, 2, progress)
    orders = {where: dense + find_orders(first, number(where), dense[-1]) for where in JOINTS}
    extra = sum(len(o) - len(dense) for o in orders.values())
    progress(f"the residual asks for {extra} orders beyond {dense[-1]}")
    steps = {}
    scale = np.repeat(1.0 / np.array(first.problem.sigma), 3)
    for index, data in enumerate(sets):
        at, fall = find_step(first.problem.residual(index), scale, first.problem.weights[index])
        if fall > STEP:
            steps[index] = int(data.row[at])
    return fit_causes(
        sets, candidates(Hints(views, orders, steps)), first.problem.placements, 2, progress, first
    )


def _refit(
    sets: Sequence[PoseSet], fitted: Fitted, stay: list[Score], progress: Callable[[str], None]
) -> Fitted:
    causes = [score.cause for score in stay]
    progress(f"{len(causes)} causes are established; fitting them")
    return fit_causes(sets, causes, fitted.problem.placements, 2, progress, fitted)


def _errors(fitted: Fitted, validation: Validation) -> Errors:
    none = np.zeros(0, dtype=int)
    series = validation.residuals(validation.series, none) if validation.series else []
    return Errors(
        [fitted.problem.residual(i) for i in range(len(fitted.problem.sets))],
        validation.residuals(validation.blocks, none),
        series,
    )


def rmse(errors: Sequence[FloatArray], kept: Sequence[BoolArray], rotation: bool = False) -> float:
    """Root mean square length of the position [m] or rotation [rad] error, shape (n, 6), over the rows that count."""
    part = slice(3, 6) if rotation else slice(0, 3)
    return verdict.rmse(np.concatenate(errors)[:, part], np.concatenate(kept), 1)


def _verdict(
    baseline: float, extended: float, floor: float, fitted: Fitted, before: Errors, found: bool
) -> str:
    lasting = any(cause.name for cause in fitted.problem.layout.causes) and found
    if not lasting:
        return verdict.CONSISTENT if baseline <= AT_NOISE * floor else verdict.UNEXPLAINED
    if extended <= AT_NOISE * floor:
        return verdict.EXPLAINED
    share = (baseline**2 - extended**2) / max(baseline**2 - floor**2, 1e-18)
    return verdict.PARTLY_EXPLAINED if share > MAIN_PART else verdict.UNEXPLAINED


def _gain(
    before: Sequence[FloatArray], after: Sequence[FloatArray], kept: Sequence[BoolArray]
) -> tuple[float, tuple[float, float]]:
    """Ratio of held-out errors, its interval from drawing blocks."""

    def sums(errors: Sequence[FloatArray]) -> FloatArray:
        squares = [np.sum(e[:, :3] ** 2, axis=1) * good for e, good in zip(errors, kept, strict=True)]
        return np.concatenate(by_block(squares))

    return bootstrap_ratio(sums(before), sums(after))


def standard_deviations(fitted: Fitted) -> FloatArray:
    """Of every coefficient: of the fit, or from the scatter of the blocks where that is larger, shape (m,)."""
    size, solution = fitted.problem.size, fitted.solution
    pull = []
    for block in fitted.blocks:
        one = np.zeros(size)
        one[block.ids] = block.g - block.H @ solution.x[block.ids]
        pull.append(one)
    shift = np.array(pull) @ solution.covariance
    scatter = np.sqrt(np.sum(shift**2, axis=0) * len(pull) / max(len(pull) - 1, 1))
    m = fitted.problem.layout.size
    result: FloatArray = np.maximum(np.sqrt(np.diag(solution.covariance)), scatter)[:m]
    return result


def distinct_share(fitted: Fitted) -> FloatArray:
    """Share of every coefficient's effect that no placement can imitate, shape (m,)."""
    m, size = fitted.problem.layout.size, fitted.problem.size
    H, _ = add_up(fitted.blocks, size)
    P = H[m:, m:] + 1e-12 * np.diag(np.diag(H)[m:])
    explained = np.sum(H[:m, m:] * np.linalg.solve(P, H[m:, :m]).T, axis=1)
    result: FloatArray = 1.0 - explained / np.maximum(np.diag(H)[:m], 1e-300)
    return result


def _model(fitted: Fitted) -> PoseModel:
    problem = fitted.problem
    layout = problem.layout
    chosen = [i for i, cause in enumerate(layout.causes) if cause.transfers]
    causes: list[PoseCause] = [layout.causes[i] for i in chosen]
    x = np.concatenate([np.zeros(0)] + [problem.x[layout.part(i)] for i in chosen])
    data = problem.sets[0]
    return PoseModel(data.robot, data.dh, problem.views[0].links, tuple(causes), x)
