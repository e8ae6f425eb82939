"""How much a trial counts that is far off: sums and weights that gross errors cannot steer."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.distributions import chi2_isf
from doormill_ros.statistics import CHI_SQUARE_MEDIAN, GROSS_SHARE, huber_weights

GROSS = 30.0  #: squared distance of a trial beyond which it may be a gross error (chance 1e-6)
_ONE = 0.01  #: chance of one trial that noise alone puts beyond the limit
_HUBER = 4.0  #: standard deviations up to which a trial keeps its full weight


def robust_sum(cost: FloatArray) -> float:
    """Sum of costs, shape (n,), in which the worst tenth counts no more than GROSS each."""
    ordered = np.sort(cost)[::-1]
    spared = int(GROSS_SHARE * len(cost))
    return float(np.minimum(ordered[:spared], GROSS).sum() + ordered[spared:].sum())


def trial_weights(distance: FloatArray, reject: bool, components: int = 3) -> FloatArray:
    """Huber weights of squared distances, shape (n,); with `reject` gross errors get zero."""
    scale2 = _usual(distance, components)
    size = np.sqrt(np.maximum(distance / scale2, 1e-12))
    weights = huber_weights(size, _HUBER)
    spared = int(GROSS_SHARE * len(distance))
    if reject and spared:
        worst = np.argsort(-distance, kind="stable")[:spared]
        weights[worst[distance[worst] > GROSS * scale2]] = 0.0
    return weights


def same_left_out(before: FloatArray, after: FloatArray) -> bool:
    """Whether two sets of weights, shape (n,) each, set the same rows aside: a fit has not settled before."""
    return bool(np.array_equal(before == 0.0, after == 0.0))


def gross_errors(distance: FloatArray, components: int) -> BoolArray:
    """Trials farther off than chance brings one of them, at most one in ten; of squared distances, shape (n,)."""
    count = len(distance)
    limit = chi2_isf(_ONE / count, components) * _usual(distance, components)
    worst = np.argsort(-distance, kind="stable")[: int(GROSS_SHARE * count)]
    gross = np.zeros(count, dtype=bool)
    gross[worst[distance[worst] > limit]] = True
    return gross


def _usual(distance: FloatArray, components: int) -> float:
    """How much larger squared distances, shape (n,), are than noise alone makes them, by their median; at least 1."""
    return max(1.0, float(np.median(distance)) / CHI_SQUARE_MEDIAN[components])
