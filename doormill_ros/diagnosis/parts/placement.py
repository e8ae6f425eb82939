"""Where a door really stood: what its place can make of deviations counts no more than the place is known.

A door measured against itself may have stood anywhere. One measured against its recorded pose stood where the localizer
says, within the covariance that it states: part of that is common to all doors (the calibration), the rest differs
from door to door. How large the rest is shows between neighbouring doors: of one recipe, whatever else is wrong with
it, or of any, where nothing is wrong with one recipe more than with another.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray

_SEEN = 1e-6  #: share of the best seen direction below which the walls see a displacement not at all
_QUARTILE = 0.3186  #: lower quartile of the size of a normal number, in standard deviations
_LEAST = (
    0.01  #: share of the stated variance that is scatter at least: a few differences may be small by chance
)
_PAIRS = 4  #: neighbouring doors of one recipe from which on their differences tell the scatter
_MEDIAN = 0.6745  #: of the size of a normal number, in standard deviations
_NEIGHBOURS = 5  #: neighbouring doors of any recipe from which on theirs do


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


class DoorPlaces:
    """Takes from whitened rows what the places of the doors can make, as far as these are not known.

    It is the root of the covariance of all rows: identity plus that of the places.
    """

    def __init__(self, columns: FloatArray, free: FloatArray) -> None:
        """Work out directions and shares.

        Args:
            columns: Of places that are known: whitened effects of independent unit variance, shape (n, k).
            free: Of places that are not, whitened, shape (n, m).
        """
        unknown, seen, _ = np.linalg.svd(free, full_matrices=False)
        unknown = unknown[:, seen > _SEEN * max(float(seen.max(initial=0.0)), 1e-30)]
        known = columns - unknown @ (unknown.T @ columns)
        basis, size, _ = np.linalg.svd(known, full_matrices=False)
        self._basis = np.hstack([unknown, basis])
        self._share = np.concatenate([np.ones(unknown.shape[1]), 1.0 - 1.0 / np.sqrt(1.0 + size**2)])

    def take(self, rows: FloatArray) -> FloatArray:
        """Whitened rows, shape (n, p), less what places can make."""
        return rows - self._basis @ (self._share[:, None] * (self._basis.T @ rows))


def scatter_between(places: FloatArray, recipe: Sequence[str], stated: FloatArray) -> FloatArray:
    """Variance of the places from door to door, at most what is stated, shape (3,).

    Args:
        places: Fitted place of each door, in order, shape (d, 3).
        recipe: What each of them is.
        stated: Variances that the localizer states, shape (3,).
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
    result: FloatArray = np.maximum(np.min(variance, axis=0), _LEAST * stated)
    return result


def block_columns(rows: IntArray, blocks: Sequence[FloatArray], n: int) -> FloatArray:
    """Columns of each door in a matrix of all n points, shape (n, sum of columns); `rows` is the door of each point."""
    found = [np.zeros((n, 0))]
    for number, block in enumerate(blocks):
        column = np.zeros((n, block.shape[1]))
        column[rows == number] = block
        found.append(column)
    return np.hstack(found)
