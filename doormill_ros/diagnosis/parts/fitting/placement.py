"""Where a door really stood: what its place can make of deviations counts no more than the place is known.

A door measured against itself may have stood anywhere. One measured against its recorded pose stood where the localizer
says, within the covariance that it states: part of that is common to all doors (the calibration), the rest differs
from door to door, as far as they scatter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.parts.doors.cut_points import CutPoints
from doormill_ros.diagnosis.parts.doors.gauged_door import GaugedDoor
from doormill_ros.diagnosis.parts.fitting.place_scatter import chance_of_places, place_error, scatter_between
from doormill_ros.diagnosis.parts.fitting.place_step import place_step

APART = 0.05  #: between places of the cell that count as two, on a joint's way over the door [m]


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
