"""Where fits of two steps begin: the best of a grid of them, and how near some come to a profile."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.edge_points.blur import bin_places
from doormill_ros.localization.edge_points.step_models import blurred_step

WIDEST = 11.0  #: px between two steps looked for
RIDGE = 1.0e-6  #: keeps least squares solvable where two steps coincide
_WIDTHS = np.geomspace(1.0, WIDEST, 12)  # px
_BLURS = np.array([0.6, 0.9, 1.3, 1.9, 2.8])  # px
_SHIFTS = np.arange(-4.0, 6.1, 0.5)  # px


@lru_cache(maxsize=4)
def _grid(size: int) -> tuple[FloatArray, FloatArray]:
    """Parameters (g, 3) of shift, width and blur; outer and inner step, their squares and product there (5 g, m)."""
    place = bin_places(size)
    shift, width, blur = (a.ravel() for a in np.meshgrid(_SHIFTS, _WIDTHS, _BLURS, indexing="ij"))
    outer = blurred_step(place - shift[:, None], blur[:, None])
    inner = blurred_step(place - (shift - width)[:, None], blur[:, None])
    products = np.concatenate([outer, inner, outer * outer, inner * inner, outer * inner])
    return np.stack([shift, width, blur], axis=1), products


def _explained(level: tuple[float, float], sums: FloatArray, moments: FloatArray) -> FloatArray:
    """Squared deviations (g,) that two steps and a level explain of a profile, the best heights taken.

    Args:
        level: Square of the level and its product with the profile.
        sums: Products of outer and inner step with the level, their squares and their product, shape (5, g).
        moments: Their products with the profile, shape (2, g).
    """
    square, moment = level[0] + RIDGE, level[1]
    # The level is eliminated first; two unknowns are left.
    outer, inner = sums[:2]
    aa, bb = sums[2] + RIDGE - outer * outer / square, sums[3] + RIDGE - inner * inner / square
    ab = sums[4] - outer * inner / square
    a, b = moments - sums[:2] * (moment / square)
    explained: FloatArray = moment**2 / square + (bb * a * a - 2 * ab * a * b + aa * b * b) / (
        aa * bb - ab * ab
    )
    return explained


def two_starts(profile: FloatArray, weight: FloatArray, few: int = 2) -> FloatArray:
    """The best places (few, 3) of two steps on a grid, of different widths; profile and weights (m,)."""
    parameters, products = _grid(profile.size)
    count = len(parameters)
    square = weight * weight
    weighted = square * profile
    sums, moments = (
        (products @ square).reshape(5, count),
        (products[: 2 * count] @ weighted).reshape(2, count),
    )
    explained = _explained((float(square.sum()), float(weighted.sum())), sums, moments)
    picked = [int(np.argmax(explained))]
    other = np.ones(count, dtype=bool)
    while len(picked) < few:
        other &= np.abs(parameters[:, 1] / parameters[picked[-1], 1] - 1) > 0.5
        if not other.any():
            break
        picked.append(int(np.argmax(np.where(other, explained, -np.inf))))
    return parameters[picked]


def nearness(profile: FloatArray, weight: FloatArray, places: FloatArray) -> FloatArray:
    """Squared deviations (n,) of a profile (m,) from two steps at `places` (n, 3), of the best heights.

    Args:
        profile: The profile.
        weight: Weights (m, m).
        places: Shift of the outer step, how far inside the inner is, and blur [px].
    """
    place = bin_places(profile.size) - places[:, :1]
    steps = blurred_step(np.stack([place, place + places[:, 1:2]]), places[:, 2:])
    outer, inner = steps @ weight.T
    level, seen = weight.sum(axis=1), weight @ profile
    squares = [(one * two).sum(axis=1) for one, two in ((outer, outer), (inner, inner), (outer, inner))]
    sums = np.stack([outer @ level, inner @ level, *squares])
    moments = np.stack([outer @ seen, inner @ seen])
    left: FloatArray = seen @ seen - _explained((float(level @ level), float(level @ seen)), sums, moments)
    return left
