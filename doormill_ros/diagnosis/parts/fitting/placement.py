"""Where a door really stood: what its place can make of deviations counts no more than the place is known.

A door measured against itself may have stood anywhere. One measured against its recorded pose stood where the localizer
says, within the covariance that it states: part of that is common to all doors (the calibration), the rest differs
from door to door. How large the rest is shows between neighbouring doors: of one recipe, whatever else is wrong with
it, or of any, where nothing is wrong with one recipe more than with another; of few, between those on one side of a
step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.parts.doors.cut_points import CutPoints
from doormill_ros.diagnosis.parts.doors.gauged_door import GaugedDoor
from doormill_ros.diagnosis.parts.fitting.place_step import place_step
from doormill_ros.distributions import chi2_ppf, chi2_sf

APART = 0.05  #: between places of the cell that count as two, on a joint's way over the door [m]
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


@dataclass(frozen=True, eq=False)
class DoorPlaces:
    """What the places of doors can make of the deviations of their points, and how the doors stand.

    Attributes:
        known: Whitened effects of the places that a localizer states, each of unit variance, shape (n, k).
        free: Those of doors that may have stood anywhere, shape (n, m).
        chance: Probability that doors stand as differently as they do by how far they are taken to scatter.
        step: Number of the door from which on they stand elsewhere; 0 for none.
    """

    known: FloatArray
    free: FloatArray
    chance: float = 1.0
    step: int = 0


def door_places(
    doors: Sequence[GaugedDoor],
    door: IntArray,
    points: CutPoints,
    noise: FloatArray,
    unexplained: FloatArray,
) -> DoorPlaces:
    """Where doors stood, by what a model leaves of their points.

    Args:
        doors: In the order in which they were milled.
        door: Number of the door of each point, shape (n,).
        points: Of all doors.
        noise: Standard deviation of each deviation, shape (n,) [m].
        unexplained: Deviations that the model leaves, in standard deviations, shape (n,).
    """
    free: list[FloatArray] = []
    known: list[FloatArray] = []
    fitted, error, recipe = [], [], []
    for number, one in enumerate(doors):
        rows = door == number
        point, normal, nothing = points.point[rows], points.normal[rows], np.zeros((rows.sum(), 0))
        scale = 1.0 / noise[rows, None]
        if one.placing is None:
            free.append(free_columns(point, normal) * scale)
            known.append(nothing)
            continue
        free.append(nothing)
        known.append(seen_columns(point, normal, one.T_base_door[:3, 3]) * scale)
        fitted.append(np.linalg.lstsq(known[-1], unexplained[rows], rcond=None)[0])
        error.append(place_error(known[-1], np.diag(one.placing)))
        recipe.append(one.recipe)
    n, anywhere = len(points), block_columns(door, free, len(points))
    placings = [one.placing for one in doors if one.placing is not None]
    if not placings:
        return DoorPlaces(np.zeros((n, 0)), anywhere)
    stated, places, errors = np.mean(placings, axis=0), np.array(fitted), np.array(error)
    own = scatter_between(places, recipe, np.diag(stated), errors)
    value, vector = np.linalg.eigh(stated - np.diag(own))
    shared = vector * np.sqrt(np.maximum(value, 0.0))  # the same for all doors
    each, together = [], np.zeros((n, 3))
    for number, block in enumerate(known):
        each.append(block * np.sqrt(own) if block.shape[1] else block)
        if block.shape[1]:
            together[door == number] = block @ shared
    return DoorPlaces(
        np.hstack([block_columns(door, each, n), together]),
        anywhere,
        chance_of_places(places, own, errors),
        place_step(places, recipe) if len(places) == len(doors) else 0,
    )


def free_columns(point: FloatArray, normal: FloatArray) -> FloatArray:
    """What displacing and turning a door does along the normals of its points, shape (n, 6), scaled to metres."""
    arm = point - point.mean(axis=0)
    size = max(float(np.linalg.norm(arm, axis=1).max()), 1e-9)
    return np.hstack([normal, np.cross(arm, normal) / size])


def seen_columns(point: FloatArray, normal: FloatArray, corner: FloatArray) -> FloatArray:
    """What y, z and the turn about x of a localized door do along the normals, shape (n, 3).

    Args:
        point: Shape (n, 3) [m].
        normal: Shape (n, 3).
        corner: Origin of the door, about which it turns, shape (3,) [m].
    """
    turned = np.cross(np.eye(3)[0], point - corner)
    return np.column_stack([normal[:, 1], normal[:, 2], np.sum(turned * normal, axis=1)])


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


def block_columns(rows: IntArray, blocks: Sequence[FloatArray], n: int) -> FloatArray:
    """Columns of each door in a matrix of all n points, shape (n, sum of columns); `rows` is the door of each point."""
    found = [np.zeros((n, 0))]
    for number, block in enumerate(blocks):
        column = np.zeros((n, block.shape[1]))
        column[rows == number] = block
        found.append(column)
    return np.hstack(found)


def places_of(centres: Sequence[FloatArray]) -> int:
    """How many places features lie in, whose centres are of shape (3,) each [m]."""
    found: list[FloatArray] = []
    for centre in centres:
        if all(np.linalg.norm(centre - other) > APART for other in found):
            found.append(centre)
    return len(found)
