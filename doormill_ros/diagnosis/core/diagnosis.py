"""From a measurement set to a verdict: what is wrong, how sure, what the extended model gains."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
from scipy.stats import chi2

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.finding import Finding, make_findings
from doormill_ros.diagnosis.core.fit import Fit
from doormill_ros.diagnosis.core.problem import C, Examined, Problem
from doormill_ros.diagnosis.core.search import ENTRY, Search
from doormill_ros.diagnosis.core.stability import beaten, clustered, instability, turned_joint, unevenness
from doormill_ros.diagnosis.core.verdict import CONSISTENT, EXPLAINED, PARTLY_EXPLAINED, UNEXPLAINED, rmse
from doormill_ros.statistics import CHI_SQUARE_MEDIAN, GROSS_SHARE, bootstrap_ratio

#: Chance of an innocent residual below which structure remains.
STRUCTURE = 1e-4
#: Chance of a stable cause below which it is not believed when structure remains.
UNSTABLE = 1e-3
#: The same when nothing else is left over.
WILD = 1e-4
#: Share of a cause by which the halves may differ when its effect is so strong that everything shows.
WILD_APART = 0.1
#: Share of the excess over the noise that a cause must explain when structure remains.
MAIN_PART = 0.3


P = TypeVar("P", bound=Examined[Any])


@dataclass(frozen=True, eq=False)
class Diagnosis(Generic[P, C]):
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

    problem: P
    search: Search[C]
    verdict: str
    findings: tuple[Finding[C], ...]
    baseline: Fit[C]
    extended: Fit[C]
    best: Fit[C]
    outliers: tuple[int, ...]
    kept: BoolArray
    train_rmse: tuple[float, float]
    holdout_rmse: tuple[float, float]
    ratio: float
    ratio_ci: tuple[float, float]
    remarks: tuple[str, ...]


def diagnose_problem(problem: P, progress: Callable[[str], None] = lambda line: None) -> Diagnosis[P, C]:
    """Search, examine and weigh what any kind of data says."""
    progress(
        f"{len(problem)} trials in {len(np.unique(problem.configuration))} configurations, "
        f"noise floor {1e6 * problem.noise_floor:.1f} um"
    )
    search, best = _search(problem, progress)
    bent = problem.bent()
    if bent is not None:
        # Heavy loads: first-order and finite joint angles differ by more than the noise.
        progress("large deflections: trying finite joint angles")
        other, found = _search(bent, progress)
        if other.total(found) < search.total(best):
            search, best, problem = other, found, bent
    outliers = _outliers(best, problem.components)
    structure = (
        has_structure(best, problem.components)
        or clustered(problem, outliers)
        or turned_joint(problem, best.prediction.white, outliers) != ""
    )
    established = _established(problem, search, best, structure)
    extended = search.fit(established, [_theta_of(best, established)])
    kept = ~outliers
    baseline = search.fit(())
    verdict = _verdict(best, established, structure)
    if verdict == EXPLAINED and len(established) < len(best.members):
        verdict = PARTLY_EXPLAINED
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
        outliers=tuple(int(t) for t in problem.labels()[outliers]),
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


def _search(problem: Examined[C], progress: Callable[[str], None]) -> tuple[Search[C], Fit[C]]:
    search = Search(problem, problem.candidates(), progress=progress)
    return search, search.run()


def _train(problem: Problem[C], found: Fit[C], kept: BoolArray) -> float:
    return rmse(problem.measured_part(found.prediction.white), kept, problem.components)


def excess_probability(found: Fit[C], components: int = 3) -> float:
    """Chance that noise alone leaves a residual as large as this."""
    kept = found.weights > 0.0
    freedom = max(components * int(kept.sum()) - int(found.free.sum()), 1)
    return float(chi2.sf(np.sum(found.prediction.white[kept] ** 2), freedom))


def has_structure(found: Fit[C], components: int = 3) -> bool:
    """Whether the residual is larger than noise can be, gross errors aside."""
    return excess_probability(found, components) < STRUCTURE


def _theta_of(found: Fit[C], members: tuple[C, ...]) -> FloatArray:
    return np.concatenate([np.zeros(0)] + [found.theta[found.part(cause)] for cause in members])


def _established(problem: Examined[C], search: Search[C], best: Fit[C], structure: bool) -> tuple[C, ...]:
    """Members that may be named."""
    named = tuple(
        cause
        for cause in best.members
        if cause.named
        and not implausible(best, cause)
        and not any(other.spoils(cause) for other in best.members if not other.named)
    )
    if not structure and len(named) == len(best.members):
        return tuple(c for c in named if not _wild(problem, best, c))
    empty = search.fit(())
    floor = float(problem.components * len(problem))
    excess = max(empty.held_out_score - floor, 1.0)
    kept = []
    for cause in named:
        without = search.without(best, cause)
        share = (without.held_out_score - best.held_out_score) / excess
        steady = min(
            instability(problem, best, cause)[0],
            unevenness(problem, best, cause, best.weights)[0],
        )
        rivals = [
            other
            for other, found in search.rivals(best, cause)
            if not other.named
            and (search.total(found) < search.total(best) + ENTRY or not beaten(problem, best, found))
        ]
        if share > MAIN_PART and steady > UNSTABLE and not rivals:
            kept.append(cause)
    return tuple(kept)


def _wild(problem: Examined[C], best: Fit[C], cause: C) -> bool:
    """Whether the parts of the data disagree about a cause, by more than a strong effect's small print."""
    probability, _, apart = instability(problem, best, cause)
    uneven, scatter = unevenness(problem, best, cause, best.weights)
    return (probability < WILD and apart > WILD_APART) or (uneven < WILD and scatter > WILD_APART)


def implausible(found: Fit[C], cause: C) -> bool:
    """Whether a cause was pushed to the end of its range, where it only imitates something else."""
    theta = found.theta[found.part(cause)]
    low = (theta < 0.98 * cause.lower) & (cause.lower < 0.0)
    high = theta > 0.98 * cause.upper
    return bool(np.any(low | high))


def _verdict(best: Fit[C], established: tuple[C, ...], structure: bool) -> str:
    if not best.members and not structure:
        return CONSISTENT
    if not established:
        return UNEXPLAINED
    return PARTLY_EXPLAINED if structure else EXPLAINED


def _outliers(best: Fit[C], components: int) -> BoolArray:
    """Gross errors, at most one in ten, shape (n,)."""
    cost = best.prediction.cost
    n = len(cost)
    scale = max(1.0, float(np.median(cost)) / CHI_SQUARE_MEDIAN[components])
    limit = chi2.isf(0.01 / n, components) * scale
    worst = np.argsort(-cost, kind="stable")[: int(GROSS_SHARE * n)]
    mask = np.zeros(n, dtype=bool)
    mask[worst[cost[worst] > limit]] = True
    return mask


def _gain(
    problem: Problem[C], baseline: Fit[C], extended: Fit[C], kept: BoolArray
) -> tuple[float, tuple[float, float]]:
    """Ratio of held-out RMSE and its 95 % interval, by resampling whole configurations."""
    numbers = np.unique(problem.configuration[kept])
    before = np.array([np.sum(baseline.held_out[kept & (problem.configuration == c)] ** 2) for c in numbers])
    after = np.array([np.sum(extended.held_out[kept & (problem.configuration == c)] ** 2) for c in numbers])
    return bootstrap_ratio(before, after)


def _remarks(
    problem: Examined[C], best: Fit[C], established: tuple[C, ...], outliers: BoolArray
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
