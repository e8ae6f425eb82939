"""How far doors scatter, by where each of them seems to have stood.

It shows between neighbouring doors: of one recipe, whatever else is wrong with it, or of any, where nothing is wrong
with one recipe more than with another; of few, between those on one side of a step.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

from doormill_ros.arrays import FloatArray
from doormill_ros.distributions import chi2_ppf, chi2_sf

_QUARTILE = 0.3186  #: lower quartile of the size of a normal number, in standard deviations
#: Share of the stated variance that is scatter at least: a few differences may be small by chance
_LEAST = 0.01
_PAIRS = 4  #: neighbouring doors of one recipe from which on their differences tell the scatter
_MEDIAN = 0.6745  #: of the size of a normal number, in standard deviations
_NEIGHBOURS = 5  #: neighbouring doors of any recipe from which on theirs do
_BESIDE_STEP = 5  #: doors from which on those on one side of a step tell it
#: Share of the stated variance to which a door's points have to tell a direction of its place to tell it at all, and
#: what stands for the share of one that they do not
_TOLD, _UNTOLD = 0.1, 1e6
#: Chance that doors which are too few for either scatter more than they are taken to.
_UNDERSTATED = 0.05


def place_error(columns: FloatArray, stated: FloatArray) -> FloatArray:
    """Covariance to which the points of a door tell its place, shape (3, 3).

    A door with one hinge hardly tells where it stands from how it is turned: such a direction counts as not told.

    Args:
        columns: What its place does to its points, whitened, shape (n, 3).
        stated: Variances that the localizer states, shape (3,).
    """
    size = np.sqrt(stated)
    told, direction = np.linalg.eigh((columns * size).T @ (columns * size))
    share = np.where(told > 1.0 / _TOLD, 1.0 / np.maximum(told, 1.0), _UNTOLD)
    error: FloatArray = np.outer(size, size) * ((direction * share) @ direction.T)
    return error


def scatter_between(
    places: FloatArray, recipe: Sequence[str], stated: FloatArray, error: FloatArray
) -> FloatArray:
    """Variance of the places from door to door, at most what is stated, shape (3,).

    Args:
        places: Fitted place of each door, in order, shape (d, 3).
        recipe: What each of them is.
        stated: Variances that the localizer states, shape (3,).
        error: Covariance to which each door's points tell its place, shape (d, 3, 3).
    """
    recipes = np.array(recipe)
    found = np.concatenate([np.diff(places[recipes == name], axis=0) for name in dict.fromkeys(recipe)])
    variance = [stated]
    if len(found) >= _PAIRS:
        # The lower quartile of their sizes: one step in a short shift shows in as many of them as there are recipes.
        variance.append((np.quantile(np.abs(found), 0.25, axis=0) / _QUARTILE) ** 2 / 2.0)
    if len(places) > _NEIGHBOURS:
        # A step shows in one of these, what is wrong with one recipe in most: either can only make them larger.
        steps = np.abs(np.diff(places, axis=0))
        variance.append((np.median(steps, axis=0) / _MEDIAN) ** 2 / 2.0)
    few = len(variance) == 1
    if few and len(found) >= 2:
        variance.append(_scatter_of_few(found, stated))
    if few and len(places) >= _BESIDE_STEP:
        variance.append(_scatter_beside_step(places, stated, error))
    result: FloatArray = np.maximum(np.min(variance, axis=0), _LEAST * stated)
    return result


def _scatter_of_few(pairs: FloatArray, stated: FloatArray) -> FloatArray:
    """Variance of the places of very few doors, shape (3,): the stated one by a share, taken high.

    Two recipes that were both milled before and after a step show it alike: how differently they changed tells the
    scatter, of four doors at once. A step that only one of them shows can only make it larger.

    Args:
        pairs: Differences between neighbouring doors of one recipe, two or more, shape (p, 3).
        stated: Variances that the localizer states, shape (3,).
    """
    count = len(pairs) // 2
    apart = (pairs[0 : 2 * count : 2] - pairs[1 : 2 * count : 2]) / np.sqrt(stated)
    share = np.sum(apart**2) / 4.0 / chi2_ppf(_UNDERSTATED, apart.size)
    return np.asarray(share * stated)


def _scatter_beside_step(places: FloatArray, stated: FloatArray, error: FloatArray) -> FloatArray:
    """Variance of the places of few doors of any recipes, shape (3,): the stated one by a share, taken high.

    The door at which they would scatter least if they stood elsewhere from there on is one of several that it could be
    (Bonferroni). What is wrong with one recipe more than with another can only make it larger.

    Args:
        places: Fitted place of each door, shape (d, 3).
        stated: Variances that the localizer states, shape (3,).
        error: Covariance to which each door's points tell its place, shape (d, 3, 3).
    """
    steps = range(1, len(places))
    told = _told_numbers(error, stated) - 2.0 * places.shape[1]
    expected = chi2_ppf(_UNDERSTATED / len(steps), max(told, 1.0))

    def beyond(share: float) -> float:
        """By how much doors stand more differently than by a share, where they do so least."""
        parts = [((places[:step], error[:step]), (places[step:], error[step:])) for step in steps]
        return min(sum(_apart(*side, share * stated) for side in sides) for sides in parts) - expected

    if beyond(_LEAST) <= 0.0:
        return _LEAST * stated
    return stated if beyond(1.0) >= 0.0 else brentq(beyond, _LEAST, 1.0) * stated


def chance_of_places(places: FloatArray, variance: FloatArray, error: FloatArray) -> float:
    """Probability that places scatter as they do, or more, by the variance that they are taken to have.

    Args:
        places: Fitted place of each door, shape (d, 3).
        variance: From door to door, shape (3,).
        error: Covariance to which each door's points tell its place, shape (d, 3, 3).
    """
    told = _told_numbers(error, variance) - places.shape[1]
    return chi2_sf(_apart(places, error, variance), max(told, 1.0))


def _apart(places: FloatArray, error: FloatArray, variance: FloatArray) -> float:
    """Squared distance of places, shape (d, 3), from their likeliest mean, in standard deviations.

    Args:
        places: Of the doors.
        error: Covariance of each, shape (d, 3, 3).
        variance: By which they scatter beside that, shape (3,).
    """
    weight = np.linalg.inv(error + np.diag(variance))
    mean = np.linalg.solve(weight.sum(axis=0), np.einsum("dij,dj->i", weight, places))
    away = places - mean
    return float(np.einsum("di,dij,dj->", away, weight, away))


def _told_numbers(error: FloatArray, variance: FloatArray) -> float:
    """How many numbers doors tell of places that scatter by a variance, shape (3,), three a door at most."""
    weight = np.linalg.inv(error + np.diag(variance))
    return float(np.einsum("dii,i->", weight, variance))
