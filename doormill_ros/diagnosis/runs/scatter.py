"""How far figures scatter from run to run, and which of them stray.

Seen by the differences between neighbours: a step shows in one of them, a hand before the lens in two.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.distributions import chi2_ppf, normal_pdf, normal_ppf
from doormill_ros.statistics import NORMAL_STD

_PAIRS = 4  #: neighbouring runs of one recipe from which on their differences tell the scatter
_SET_ASIDE = 0.15  #: share of the differences that may show a step, or a run gone wrong
#: Chance that a scatter told by few differences is larger than it is taken to be; neighbouring ones share a run.
_UNDERSTATED, _INDEPENDENT = 0.2, 0.6
_ANY = 10.0  #: of recipes that hardly ever follow each other, by which nobody knows how they differ
#: What makes a stray: runs of a recipe, runs on either side, standard deviations.
_FEWEST, _BESIDE, _FAR = 4, 3, 8.0


def neighbours(values: FloatArray, recipes: Sequence[str]) -> tuple[FloatArray, FloatArray]:
    """Differences from the run of the same recipe before, and between neighbours of two recipes.

    Args:
        values: Shape (r,); runs without a figure (nan) are left out.
        recipes: Of the runs.
    """
    recipe, told = np.array(recipes), np.isfinite(values)
    same = [np.diff(values[told & (recipe == one)]) for one in dict.fromkeys(recipes)]
    between = recipe[told][1:] != recipe[told][:-1]
    return np.concatenate([np.zeros(0), *same]), np.diff(values[told])[between]


def variance_of(differences: FloatArray) -> float:
    """Variance of one figure by the smaller ones of differences between two, shape (d,); 0 where there are none.

    The largest differences are set aside and the rest taken for a normal distribution that is cut off there.
    """
    count = len(differences)
    kept = count - int(np.ceil(_SET_ASIDE * count)) - (count > 2)
    if kept < 1:
        return 0.0
    share = (kept + 0.5) / (count + 1.0)
    end = normal_ppf((1.0 + share) / 2.0)
    cut = 1.0 - 2.0 * end * normal_pdf(end) / share
    smallest = np.sort(differences**2)[:kept]
    freedom = max(_INDEPENDENT * count, 1.0)
    high = freedom / chi2_ppf(_UNDERSTATED, freedom)
    return float(smallest.mean() / cut / 2.0 * high)


def scatters(values: FloatArray, recipes: Sequence[str], least: float) -> tuple[float, float]:
    """Standard deviations of a figure from run to run, and of its recipes against each other.

    Args:
        values: Shape (r,), nan where a run tells none.
        recipes: Of the runs.
        least: Smallest standard deviation that is believed.
    """
    same, other = (
        variance_of(found) if len(found) >= _PAIRS else None for found in neighbours(values, recipes)
    )
    if same is None:  # recipes that come once: what they differ by is chance
        same, other = variance_of(np.diff(values[np.isfinite(values)])), 0.0
    own = max(same, least**2)
    return float(np.sqrt(own)), float(np.sqrt(max(other - own, 0.0))) if other is not None else _ANY


def strays(values: FloatArray, recipes: Sequence[str], least: float) -> BoolArray:
    """Figures of single runs that lie far from each of those before and of those after, shape (r,).

    Args:
        values: Shape (r,), nan where a run tells none.
        recipes: Of the runs.
        least: Smallest standard deviation that is believed.
    """
    found, same = np.zeros(len(values), dtype=bool), neighbours(values, recipes)[0]
    if len(same) < _PAIRS:
        return found
    limit = _FAR * max(float(np.median(np.abs(same))) * NORMAL_STD / np.sqrt(2.0), least)
    for one in dict.fromkeys(recipes):
        rows = np.flatnonzero((np.array(recipes) == one) & np.isfinite(values))
        for at, row in enumerate(rows if len(rows) >= _FEWEST else ()):
            around = [*rows[max(at - _BESIDE, 0) : at], *rows[at + 1 : at + 1 + _BESIDE]]
            apart = values[row] - values[around]
            found[row] = bool(np.all(apart > limit) or np.all(apart < -limit))
    return found
