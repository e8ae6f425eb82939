"""From a measurement set to a verdict: what is wrong, how sure, what the extended model gains."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from doormill_ros.diagnosis.causes.cause import Cause
from doormill_ros.diagnosis.causes.registry import candidates
from doormill_ros.diagnosis.fit import OUTLIER_SHARE, Fit, bounds, normal_equations
from doormill_ros.diagnosis.measurement_set import MeasurementSet
from doormill_ros.diagnosis.patterns import spoils, unnamed_patterns
from doormill_ros.diagnosis.problem import Problem
from doormill_ros.diagnosis.search import ENTRY, EQUAL, Search
from doormill_ros.diagnosis.stability import instability

#: Chance of an innocent residual below which structure remains.
STRUCTURE = 1e-4
#: Chance of a stable cause below which it is not believed when structure remains.
UNSTABLE = 1e-3
#: The same when nothing else is left over.
WILD = 1e-4
#: Difference between first-order and finite joint angles, in noise floors, from which both are tried.
CURVED = 0.3
#: Fall of the score with one more number that chance reaches once in ten sets.
LEANING = 2.7
#: Share of the excess over the noise that a cause must explain when structure remains.
MAIN_PART = 0.3


@dataclass(frozen=True, eq=False)
class Finding:
    """One established cause.

    Attributes:
        cause: The cause.
        values, std: Reported parameters and their standard deviations, in a row.
        confusable: Other causes that would do as well.
        without: Held-out RMSE of the extended model less this cause [m].
        rivals: All alternatives in its place with their held-out scores, the best first.
    """

    cause: Cause
    values: np.ndarray
    std: np.ndarray
    confusable: tuple[Cause, ...]
    without: float
    rivals: tuple[tuple[Cause, float], ...]


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """Everything that a diagnosis knows.

    Attributes:
        problem: The set made ready.
        search: All models that were tried.
        verdict: consistent, explained, partly_explained or unexplained.
        findings: Established causes.
        baseline: The model in question.
        extended: The model with the established causes.
        best: The best model found, patterns without a name included.
        outliers: Trial numbers.
        kept: Trials that count, shape (n,).
        train_rmse, holdout_rmse: Of baseline and extended model [m].
        ratio, ratio_ci: Held-out RMSE extended over baseline, and its 95 % interval.
        remarks: Sentences for the reader.
    """

    problem: Problem
    search: Search
    verdict: str
    findings: tuple[Finding, ...]
    baseline: Fit
    extended: Fit
    best: Fit
    outliers: tuple[int, ...]
    kept: np.ndarray
    train_rmse: tuple[float, float]
    holdout_rmse: tuple[float, float]
    ratio: float
    ratio_ci: tuple[float, float]
    remarks: tuple[str, ...]


def diagnose_set(data: MeasurementSet, progress: Callable[[str], None] = lambda line: None) -> Diagnosis:
    """Question the simulation of one loading test."""
    problem = Problem(data)
    progress(
        f"{len(data)} trials in {len(np.unique(problem.configuration))} configurations, "
        f"noise floor {1e6 * problem.noise_floor:.1f} um"
    )
    search, best = _search(problem, progress)
    if np.sqrt(np.mean(problem.curvature**2)) > CURVED * problem.noise_floor:
        # Heavy loads: first-order and finite joint angles differ by more than the noise.
        progress("large deflections: trying finite joint angles")
        other, bent = _search(Problem(data, finite=True), progress)
        if other.total(bent) < search.total(best):
            search, best, problem = other, bent, other.problem
    structure = has_structure(best)
    established = _established(search, best, structure)
    extended = search.fit(established, [_theta_of(best, established)])
    outliers = _outliers(best)
    kept = ~outliers
    baseline = search.fit(())
    verdict = _verdict(best, established, structure)
    if verdict == "explained" and len(established) < len(best.members):
        verdict = "partly_explained"
    findings = tuple(_finding(search, best, extended, cause, structure, kept) for cause in established)
    ratio, interval = _gain(problem, baseline, extended, kept)
    return Diagnosis(
        problem=problem,
        search=search,
        verdict=verdict,
        findings=findings,
        baseline=baseline,
        extended=extended,
        best=best,
        outliers=tuple(int(t) for t in data.trial[outliers]),
        kept=kept,
        train_rmse=(rmse(baseline.prediction.residual, kept), rmse(extended.prediction.residual, kept)),
        holdout_rmse=(rmse(baseline.held_out, kept), rmse(extended.held_out, kept)),
        ratio=ratio,
        ratio_ci=interval,
        remarks=_remarks(problem, best, established, verdict, search),
    )


def _search(problem: Problem, progress: Callable[[str], None]) -> tuple[Search, Fit]:
    data = problem.data
    library = candidates(dict.fromkeys(data.reflector.tolist()))
    patterns = unnamed_patterns(data.q, data.time, data.temperature, data.dt)
    search = Search(problem, [*library, *patterns], progress=progress)
    return search, search.run()


def rmse(residual: np.ndarray, kept: np.ndarray) -> float:
    """Root mean square over all components of the trials that count [m]."""
    return float(np.sqrt(np.mean(residual[kept] ** 2)))


def excess_probability(found: Fit) -> float:
    """Chance that noise alone leaves a residual as large as this."""
    kept = found.weights > 0.0
    freedom = max(3 * int(kept.sum()) - int(found.free.sum()), 1)
    return float(chi2.sf(np.sum(found.prediction.white[kept] ** 2), freedom))


def has_structure(found: Fit) -> bool:
    """Whether the residual is larger than noise can be, gross errors aside."""
    return excess_probability(found) < STRUCTURE


def _theta_of(found: Fit, members: tuple[Cause, ...]) -> np.ndarray:
    return np.concatenate([np.zeros(0)] + [found.theta[found.part(cause)] for cause in members])


def _established(search: Search, best: Fit, structure: bool) -> tuple[Cause, ...]:
    """Members that may be named."""
    named = tuple(
        cause
        for cause in best.members
        if cause.named
        and not implausible(best, cause)
        and not any(spoils(other, cause) for other in best.members if not other.named)
    )
    if not structure and len(named) == len(best.members):
        return tuple(c for c in named if instability(search.problem, best, c)[0] > WILD)
    empty = search.fit(())
    floor = 3.0 * len(search.problem)
    excess = max(empty.held_out_score - floor, 1.0)
    kept = []
    for cause in named:
        without = search.without(best, cause)
        share = (without.held_out_score - best.held_out_score) / excess
        probability, _ = instability(search.problem, best, cause)
        rivals = [
            other
            for other, found in search.rivals(best, cause)
            if not other.named and search.total(found) < search.total(best) + ENTRY
        ]
        if share > MAIN_PART and probability > UNSTABLE and not rivals:
            kept.append(cause)
    return tuple(kept)


def implausible(found: Fit, cause: Cause) -> bool:
    """Whether a cause was pushed to the end of its range, where it only imitates something else."""
    theta = found.theta[found.part(cause)]
    low = (theta < 0.98 * cause.lower) & (cause.lower < 0.0)
    high = theta > 0.98 * cause.upper
    return bool(np.any(low | high))


def _verdict(best: Fit, established: tuple[Cause, ...], structure: bool) -> str:
    if not best.members and not structure:
        return "consistent"
    if not established:
        return "unexplained"
    return "partly_explained" if structure else "explained"


def _outliers(best: Fit) -> np.ndarray:
    """Gross errors, at most one in ten, shape (n,)."""
    cost = best.prediction.cost
    n = len(cost)
    scale = max(1.0, float(np.median(cost)) / 2.366)
    limit = chi2.isf(0.01 / n, 3) * scale
    worst = np.argsort(cost)[::-1][: int(OUTLIER_SHARE * n)]
    mask = np.zeros(n, dtype=bool)
    mask[worst[cost[worst] > limit]] = True
    return mask


def _finding(
    search: Search, best: Fit, extended: Fit, cause: Cause, structure: bool, kept: np.ndarray
) -> Finding:
    problem = search.problem
    part = best.part(cause)
    theta = best.theta[part]
    covariance = best.covariance[part, part]
    if structure:
        good = best.weights > 0.0
        covariance = covariance * float(np.mean(best.prediction.cost[good])) / 3.0
    values = cause.values(theta, problem.case)
    slope = np.zeros((len(values), cause.size))
    for i in range(cause.size):
        step = 1e-6 * max(abs(theta[i]), cause.scale[i])
        moved = theta.copy()
        moved[i] += step
        slope[:, i] = (cause.values(moved, problem.case) - values) / step
    std = np.sqrt(np.clip(np.diag(slope @ covariance @ slope.T), 0.0, None))
    for i in cause.kinked:
        std[i] = abs(slope[i, i]) * profile_std(problem, best, part.start + i)
    rivals = search.rivals(best, cause)
    confusable: list[Cause] = []
    for other, found in rivals:
        nested = other.where == cause.where and cause.name in (other.generalises, other.name)
        # A law that contains this one counts as another only if the data lean towards it.
        nested = nested and (other.name == cause.name or found.score > best.score - LEANING)
        if other.named and not nested and found.held_out_score < best.held_out_score + EQUAL:
            confusable.append(other)
    unique = {other.key: other for other in reversed(confusable) if other.key != cause.key}
    return Finding(
        cause=cause,
        values=values,
        std=std,
        confusable=tuple(reversed(unique.values())),
        without=rmse(search.without(extended, cause).held_out, kept),
        rivals=tuple((other, found.held_out_score) for other, found in rivals),
    )


def profile_std(problem: Problem, found: Fit, index: int) -> float:
    """Standard deviation of one number from how far it can move until the cost has risen by 4.

    The others follow to first order. For numbers in which the cost has kinks, or that sit on
    zero, where the curvature says nothing.
    """
    lower, upper = bounds(found.members)
    others = found.free.copy()
    others[index] = False
    weights = found.weights

    def cost(value: float) -> float:
        theta = found.theta.copy()
        theta[index] = value
        for _ in range(2):
            prediction = problem.predict(found.members, theta, derivative=True)
            if not others.any():
                break
            matrix, descent = normal_equations(prediction, weights)
            matrix = matrix[np.ix_(others, others)] + 1e-12 * np.eye(int(others.sum()))
            theta[others] += np.linalg.solve(matrix, descent[others])
            theta = np.clip(theta, lower, upper)
        return float(weights @ problem.predict(found.members, theta).cost)

    start = float(found.theta[index])
    least = float(weights @ found.prediction.cost)
    reach = []
    for end in (lower[index], upper[index]):
        before = (0.0, 0.0)
        reach.append(abs(end - start))
        for value in start + (end - start) * np.geomspace(1e-3, 1.0, 25):
            rise = cost(value) - least
            if rise > 4.0:
                share = (4.0 - before[1]) / max(rise - before[1], 1e-9)
                reach[-1] = before[0] + share * (abs(value - start) - before[0])
                break
            before = (abs(value - start), max(rise, 0.0))
    return max(reach) / 2.0


def _gain(
    problem: Problem, baseline: Fit, extended: Fit, kept: np.ndarray
) -> tuple[float, tuple[float, float]]:
    """Ratio of held-out RMSE and its 95 % interval, by resampling whole configurations."""
    numbers = np.unique(problem.configuration[kept])
    before = np.array([np.sum(baseline.held_out[kept & (problem.configuration == c)] ** 2) for c in numbers])
    after = np.array([np.sum(extended.held_out[kept & (problem.configuration == c)] ** 2) for c in numbers])
    draws = np.random.default_rng(0).integers(0, len(numbers), (2000, len(numbers)))
    ratios = np.sqrt(after[draws].sum(axis=1) / before[draws].sum(axis=1))
    low, high = np.quantile(ratios, [0.025, 0.975])
    return float(np.sqrt(after.sum() / before.sum())), (float(low), float(high))


def _remarks(
    problem: Problem, best: Fit, established: tuple[Cause, ...], verdict: str, search: Search
) -> tuple[str, ...]:
    lines = []
    if len(np.unique(problem.configuration)) == 1:
        lines.append(
            "All trials share one configuration, so single trials were left out instead of configurations."
        )
    unnamed = [cause for cause in best.members if not cause.named]
    if unnamed:
        lines.append(
            "Looks like " + " and ".join(c.pattern() for c in unnamed) + ", for which there is no cause."
        )
    dropped = [c for c in best.members if c.named and c not in established]
    for cause in dropped:
        probability, where = instability(problem, best, cause)
        why = (
            f"it has another size in the halves by {where}"
            if probability < UNSTABLE
            else "others would do as well"
        )
        lines.append(f"{cause!r} comes closest but is not believed: {why}.")
    return tuple(lines)
