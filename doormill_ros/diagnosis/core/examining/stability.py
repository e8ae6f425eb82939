"""Does a cause say the same in every part of the data? A wrong one that only resembles the truth does not."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.fitting.problem import C, Examined, Problem
from doormill_ros.distributions import chi2_sf

#: Chance with which honest gross errors sit together, or turn one joint, as much.
CLUSTERED = 1e-3
#: Chance with which an equal model loses in as many configurations.
BEATEN = 0.05
_SAME_CHANCE = 1e-3  #: share by which two chances differ that are not the same
_SAME = 0.1  #: difference of the cost of a configuration below which it speaks for neither model
_NOTHING = 1e-3  #: standard deviations that two fits of one prediction may be apart


def instability(problem: Examined[C], found: Fit[C], cause: C) -> tuple[float, str, float]:
    """Smallest probability, over all cuts, that both halves hold the same cause of the same size.

    The residual's own size is the yardstick, so that structure left by something else does not
    condemn a cause by itself. The probability is corrected for the number of cuts.

    Returns:
        Probability, the cut that gave it, and how far the halves are apart there as a share of the cause.
    """
    part = found.part(cause)
    prediction, weights = found.prediction, np.sqrt(found.weights)[:, None]
    target = (prediction.white * weights).ravel()
    base = prediction.derived * weights[:, :, None]
    kept = float((found.weights > 0.0).sum())
    freedom = max(problem.components * kept - found.size, 1.0)
    left = float(target @ target)
    cuts = problem.cuts()
    size = max(float(np.linalg.norm(found.theta[part])), 1e-30)
    worst, where, apart = 1.0, "", 0.0
    for name, mask in cuts.items():
        own = base[:, :, part] * mask[:, None, None]
        block = np.concatenate([base, own], axis=2).reshape(len(target), -1)
        solution, _, rank, _ = np.linalg.lstsq(block, target, rcond=1e-9)
        gain = left - float(np.sum((target - block @ solution) ** 2))
        after = max(freedom - (rank - found.size), 1.0)
        scale = max((left - gain) / after, 1.0)
        probability = chi2_sf(max(gain, 0.0) / scale, max(rank - found.size, 1))
        # Two cuts that are each other's complement are equal but for rounding: the first of them stays.
        if probability < worst * (1.0 - _SAME_CHANCE):
            worst, where = probability, name
            apart = float(np.linalg.norm(solution[found.size :])) / size
    return min(1.0, worst * max(len(cuts), 1)), where, apart


def clustered(problem: Examined[C], gross: BoolArray) -> bool:
    """Whether gross errors sit together in few configurations or on one reflector.

    Args:
        problem: The set.
        gross: The trials in question, shape (n,).
    """
    return clustering(problem, gross) < CLUSTERED


def clustering(problem: Examined[C], gross: BoolArray) -> float:
    """Chance with which slips of the hand, which fall anywhere, sit together as much as some trials do.

    An unknown effect that shows in a few postures only does not fall anywhere. The smaller chance of two, by
    configurations and by reflectors; 1 for fewer than three trials.

    Args:
        problem: The set.
        gross: The trials in question, shape (n,).
    """
    if gross.sum() < 3:
        return 1.0
    return min(chance_together(groups, gross) for groups in problem.groupings())


def chance_together(groups: IntArray, chosen: BoolArray) -> float:
    """Chance that as many rows drawn without replacement share groups as much as the chosen ones, exactly.

    The measure is the sum of the squared numbers of chosen rows in each group. Independent binomial draws in
    every group, on condition that they add up, are draws without replacement; the joint distribution of
    their sum and of their sum of squares is built up group by group.

    Args:
        groups: Group of every row, shape (n,).
        chosen: Shape (n,).
    """
    from scipy.stats import binom  # late: it takes a second, and few sets have gross errors

    _, number, size = np.unique(groups, return_inverse=True, return_counts=True)
    wanted = int(chosen.sum())
    together = int(np.sum(np.bincount(number, weights=chosen) ** 2))
    # Rows: how many were drawn so far; columns: sum of squares so far, all from `together` on in the last one.
    chance = np.zeros((wanted + 1, together + 1))
    chance[0, 0] = 1.0
    for count in size:
        after = np.zeros_like(chance)
        shares = binom.pmf(np.arange(min(int(count), wanted) + 1), count, wanted / len(number))
        for k, share in enumerate(shares):
            square, left = min(k * k, together), wanted + 1 - k
            after[k:, square:] += share * chance[:left, : together + 1 - square]
            after[k:, together] += share * chance[:left, together + 1 - square :].sum(axis=1)
        chance = after
    return float(chance[wanted, together] / chance[wanted].sum())


def turned_joint(problem: Examined[C], residual: FloatArray, gross: BoolArray) -> str:
    """The joint that gross errors, marks of shape (n,), all point along as if it had turned; empty for none."""
    joint, chance = problem.turning(residual, gross)
    return joint if chance < CLUSTERED else ""


def unevenness(problem: Problem[C], found: Fit[C], cause: C, weights: FloatArray) -> tuple[float, float]:
    """Chance that a cause of one size leaves as much scatter between the configurations, and that scatter.

    Every configuration may hold its own amount of the cause. A spring that changes from posture to
    posture averages to the same value in any two halves of the data, and is found out here.

    Args:
        problem: The set.
        found: A model.
        cause: One of its members.
        weights: Of the trials, shape (n,).

    Returns:
        Probability, and the weighted standard deviation of the amounts as a share of the cause.
    """
    part = found.part(cause)
    prediction, root = found.prediction, np.sqrt(weights)
    target = (prediction.white * root[:, None]).ravel()
    base = (prediction.derived * root[:, None, None]).reshape(len(target), -1)
    amount = (prediction.derived[:, :, part] @ found.theta[part]) * root[:, None]
    numbers, group = np.unique(problem.configuration, return_inverse=True)
    if len(numbers) < 2:
        return 1.0, 0.0
    own = (amount[:, :, None] * np.eye(len(numbers))[group][:, None]).reshape(len(target), -1)
    plain = target - base @ np.linalg.lstsq(base, target, rcond=1e-9)[0]
    both = np.concatenate([base, own], axis=1)
    solution, _, rank, _ = np.linalg.lstsq(both, target, rcond=1e-9)
    rest = target - both @ solution
    gain = float(plain @ plain - rest @ rest)
    more = max(rank - np.linalg.matrix_rank(base, rtol=1e-9), 1)
    freedom = max(problem.components * float((weights > 0.0).sum()) - rank, 1.0)
    scale = max(float(rest @ rest) / freedom, 1.0)
    shares, power = solution[found.size :], np.sum(own**2, axis=0)
    power = power / max(float(power.sum()), 1e-30)
    scatter = float(np.sqrt(power @ (shares - power @ shares) ** 2))
    return chi2_sf(max(gain, 0.0) / scale, more), scatter


def beaten(problem: Problem[C], best: Fit[C], other: Fit[C]) -> bool:
    """Whether a model predicts worse in most configurations, not only in a few that decide the sum.

    What no cause explains is the same within a posture and differs between them, so postures are
    what counts: Wilcoxon's signed ranks of the differences of their held-out cost.
    """
    from scipy.stats import wilcoxon  # late, as above

    difference = other.held_out_cost - best.held_out_cost
    sums = np.bincount(np.unique(problem.configuration, return_inverse=True)[1], weights=difference)
    sums = sums[np.abs(sums) > _SAME]
    return len(sums) > 0 and float(wilcoxon(sums, alternative="greater").pvalue) < BEATEN


def same(one: Fit[C], other: Fit[C]) -> bool:
    """Whether two models predict the same in every trial: no more than rounding of the fits is between them."""
    apart = np.abs(one.prediction.white - other.prediction.white)
    return bool(apart.max(initial=0.0) < _NOTHING)
