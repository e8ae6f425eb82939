"""From a measurement set to a verdict: what is wrong, how sure, what the extended model gains."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.loading.finding import Finding, make_findings, rmse
from doormill_ros.diagnosis.loading.fit import MEDIAN, OUTLIER_SHARE, Fit
from doormill_ros.diagnosis.loading.patterns import spoils, unnamed_patterns
from doormill_ros.diagnosis.loading.problem import Problem
from doormill_ros.diagnosis.loading.search import ENTRY, Search
from doormill_ros.diagnosis.loading.stability import beaten, clustered, instability, turned_joint, unevenness
from doormill_ros.measurements.measurement_set import MeasurementSet
from doormill_ros.robot_model.elastic.causes.cause import Cause
from doormill_ros.robot_model.elastic.causes.registry import candidates
from doormill_ros.statistics import bootstrap_ratio

#: Chance of an innocent residual below which structure remains.
STRUCTURE = 1e-4
#: Chance of a stable cause below which it is not believed when structure remains.
UNSTABLE = 1e-3
#: The same when nothing else is left over.
WILD = 1e-4
#: Share of a cause by which the halves may differ when its effect is so strong that everything shows.
WILD_APART = 0.1
#: Difference between first-order and finite joint angles, in noise floors, from which both are tried.
CURVED = 0.3
#: Share of the excess over the noise that a cause must explain when structure remains.
MAIN_PART = 0.3


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
    kept: FloatArray
    train_rmse: tuple[float, float]
    holdout_rmse: tuple[float, float]
    ratio: float
    ratio_ci: tuple[float, float]
    remarks: tuple[str, ...]


def diagnose_set(data: MeasurementSet, progress: Callable[[str], None] = lambda line: None) -> Diagnosis:
    """Question the simulation of one loading test."""
    return diagnose_problem(Problem(data), progress)


def diagnose_problem(
    problem: Problem,
    progress: Callable[[str], None] = lambda line: None,
    allowed: Callable[[Cause], bool] = lambda cause: True,
) -> Diagnosis:
    """The same for a problem made elsewhere, with the causes that can act there."""
    data = problem.data
    progress(
        f"{len(data)} trials in {len(np.unique(problem.configuration))} configurations, "
        f"noise floor {1e6 * problem.noise_floor:.1f} um"
    )
    search, best = _search(problem, progress, allowed)
    if np.sqrt(np.mean(problem.curvature**2)) > CURVED * problem.noise_floor:
        # Heavy loads: first-order and finite joint angles differ by more than the noise.
        progress("large deflections: trying finite joint angles")
        curved = Problem(data, True, problem.sight, problem.configuration)
        other, bent = _search(curved, progress, allowed)
        if other.total(bent) < search.total(best):
            search, best, problem = other, bent, other.problem
    outliers = _outliers(best, problem.components)
    structure = (
        has_structure(best, problem.components)
        or clustered(problem, outliers)
        or turned_joint(problem, best.prediction.white, outliers) != ""
    )
    established = _established(search, best, structure)
    extended = search.fit(established, [_theta_of(best, established)])
    kept = ~outliers
    baseline = search.fit(())
    verdict = _verdict(best, established, structure)
    if verdict == "explained" and len(established) < len(best.members):
        verdict = "partly_explained"
    findings = make_findings(search, best, extended, established, structure, kept)
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
        train_rmse=(_train(problem, baseline, kept), _train(problem, extended, kept)),
        holdout_rmse=(
            rmse(baseline.held_out, kept, problem.components),
            rmse(extended.held_out, kept, problem.components),
        ),
        ratio=ratio,
        ratio_ci=interval,
        remarks=_remarks(problem, best, established, outliers),
    )


def _search(
    problem: Problem, progress: Callable[[str], None], allowed: Callable[[Cause], bool]
) -> tuple[Search, Fit]:
    data = problem.data
    library = [cause for cause in candidates(dict.fromkeys(data.reflector.tolist())) if allowed(cause)]
    patterns = unnamed_patterns(data.q, data.time, data.temperature, data.dt)
    search = Search(problem, [*library, *patterns], progress=progress)
    return search, search.run()


def _train(problem: Problem, found: Fit, kept: FloatArray) -> float:
    return rmse(problem.measured_part(found.prediction.white), kept, problem.components)


def excess_probability(found: Fit, components: int = 3) -> float:
    """Chance that noise alone leaves a residual as large as this."""
    kept = found.weights > 0.0
    freedom = max(components * int(kept.sum()) - int(found.free.sum()), 1)
    return float(chi2.sf(np.sum(found.prediction.white[kept] ** 2), freedom))


def has_structure(found: Fit, components: int = 3) -> bool:
    """Whether the residual is larger than noise can be, gross errors aside."""
    return excess_probability(found, components) < STRUCTURE


def _theta_of(found: Fit, members: tuple[Cause, ...]) -> FloatArray:
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
        return tuple(c for c in named if not _wild(search.problem, best, c))
    empty = search.fit(())
    floor = float(search.problem.components * len(search.problem))
    excess = max(empty.held_out_score - floor, 1.0)
    kept = []
    for cause in named:
        without = search.without(best, cause)
        share = (without.held_out_score - best.held_out_score) / excess
        steady = min(
            instability(search.problem, best, cause)[0],
            unevenness(search.problem, best, cause, best.weights)[0],
        )
        rivals = [
            other
            for other, found in search.rivals(best, cause)
            if not other.named
            and (search.total(found) < search.total(best) + ENTRY or not beaten(search.problem, best, found))
        ]
        if share > MAIN_PART and steady > UNSTABLE and not rivals:
            kept.append(cause)
    return tuple(kept)


def _wild(problem: Problem, best: Fit, cause: Cause) -> bool:
    """Whether the parts of the data disagree about a cause, by more than a strong effect's small print."""
    probability, _, apart = instability(problem, best, cause)
    uneven, scatter = unevenness(problem, best, cause, best.weights)
    return (probability < WILD and apart > WILD_APART) or (uneven < WILD and scatter > WILD_APART)


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


def _outliers(best: Fit, components: int) -> FloatArray:
    """Gross errors, at most one in ten, shape (n,)."""
    cost = best.prediction.cost
    n = len(cost)
    scale = max(1.0, float(np.median(cost)) / MEDIAN[components])
    limit = chi2.isf(0.01 / n, components) * scale
    worst = np.argsort(-cost, kind="stable")[: int(OUTLIER_SHARE * n)]
    mask = np.zeros(n, dtype=bool)
    mask[worst[cost[worst] > limit]] = True
    return mask


def _gain(
    problem: Problem, baseline: Fit, extended: Fit, kept: FloatArray
) -> tuple[float, tuple[float, float]]:
    """Ratio of held-out RMSE and its 95 % interval, by resampling whole configurations."""
    numbers = np.unique(problem.configuration[kept])
    before = np.array([np.sum(baseline.held_out[kept & (problem.configuration == c)] ** 2) for c in numbers])
    after = np.array([np.sum(extended.held_out[kept & (problem.configuration == c)] ** 2) for c in numbers])
    return bootstrap_ratio(before, after)


def _remarks(
    problem: Problem, best: Fit, established: tuple[Cause, ...], outliers: FloatArray
) -> tuple[str, ...]:
    lines = []
    joint = turned_joint(problem, best.prediction.white, outliers)
    if joint:
        lines.append(
            f"The trials that look like gross errors all point along a turn of {joint}: an effect, not slips."
        )
    elif clustered(problem, outliers):
        lines.append(
            "The trials that look like gross errors sit together in few configurations or on one reflector: "
            "an effect, not slips."
        )
    if len(np.unique(problem.configuration)) == 1:
        lines.append(
            "All trials share one configuration, so single trials were left out instead of configurations."
        )
    unnamed = [cause for cause in best.members if not cause.named]
    if unnamed:
        lines.append(
            "The residual looks like "
            + " and ".join(c.pattern() for c in unnamed)
            + ", which no known cause leaves."
        )
    dropped = [c for c in best.members if c.named and c not in established]
    for cause in dropped:
        probability, where, _ = instability(problem, best, cause)
        if probability < UNSTABLE:
            why = f"it has another size in the halves by {where}"
        elif unevenness(problem, best, cause, best.weights)[0] < UNSTABLE:
            why = "its size changes from configuration to configuration"
        else:
            why = "others would do as well"
        lines.append(f"{cause!r} comes closest but is not believed: {why}.")
    return tuple(lines)
