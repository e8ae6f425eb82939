"""Which members of a model may be named, and what speaks against the others: for fits by robust least squares."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from doormill_ros.arrays import BoolArray
from doormill_ros.diagnosis.core.beam import ENTRY, BeamSearch
from doormill_ros.diagnosis.core.fit import Fit
from doormill_ros.diagnosis.core.problem import C, Examined
from doormill_ros.diagnosis.core.stability import beaten, clustered, instability, turned_joint, unevenness
from doormill_ros.statistics import CHI_SQUARE_MEDIAN, GROSS_SHARE

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


def excess_probability(found: Fit[C], components: int = 3) -> float:
    """Chance that noise alone leaves a residual as large as this."""
    kept = found.weights > 0.0
    freedom = max(components * int(kept.sum()) - int(found.free.sum()), 1)
    return float(chi2.sf(np.sum(found.prediction.white[kept] ** 2), freedom))


def has_structure(problem: Examined[C], best: Fit[C], outliers: BoolArray) -> bool:
    """Whether the residual is larger than noise can be, or what looks like gross errors, marks (n,), is an effect."""
    return (
        excess_probability(best, problem.components) < STRUCTURE
        or clustered(problem, outliers)
        or turned_joint(problem, best.prediction.white, outliers) != ""
    )


def established(problem: Examined[C], search: BeamSearch[C], best: Fit[C], structure: bool) -> tuple[C, ...]:
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


def reason_against(problem: Examined[C], best: Fit[C], cause: C) -> str:
    """Why a member of the best model is not believed."""
    probability, where, _ = instability(problem, best, cause)
    if probability < UNSTABLE:
        return f"it has another size in the halves by {where}"
    if unevenness(problem, best, cause, best.weights)[0] < UNSTABLE:
        return "its size changes from configuration to configuration"
    return "others would do as well"


def gross_errors(best: Fit[C], components: int) -> BoolArray:
    """Gross errors, at most one in ten, shape (n,)."""
    cost = best.prediction.cost
    n = len(cost)
    scale = max(1.0, float(np.median(cost)) / CHI_SQUARE_MEDIAN[components])
    limit = chi2.isf(0.01 / n, components) * scale
    worst = np.argsort(-cost, kind="stable")[: int(GROSS_SHARE * n)]
    mask = np.zeros(n, dtype=bool)
    mask[worst[cost[worst] > limit]] = True
    return mask
