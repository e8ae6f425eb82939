"""The door as wood: which of it may be taken, and which is still there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.recipe import Recipe

CHUNK = 2_000_000  #: pairs of points and tools looked at in one go


@dataclass(frozen=True, eq=False)
class Pocket:
    """What one feature takes away: its outline drawn out from the surface to its floor.

    Attributes:
        feature: Identifier in the recipe.
        T_door_feature: Shape (4, 4).
        half: Half width and half length of the outline less the corner radius, shape (2,) [m].
        corner: Corner radius [m].
        depth: Depth of the floor, infinite for a hole that goes through [m].
        low: Lowest corner of the pocket within the door, door frame, shape (3,) [m].
        high: Its highest corner, shape (3,) [m].
    """

    feature: str
    T_door_feature: FloatArray
    half: FloatArray
    corner: float
    depth: float
    low: FloatArray
    high: FloatArray

    @classmethod
    def of(cls, recipe: Recipe, feature: Feature) -> Pocket:
        """The pocket of a recipe's feature."""
        T, shape = recipe.T_door_feature(feature), feature.shape
        depth = feature.cut_depth(recipe.size)
        extent = np.array([shape.width / 2.0, shape.length / 2.0])
        ends = np.stack([T[:3, 3], T[:3, 3] + depth * T[:3, 2]])
        span = np.abs(T[:3, :2]) @ extent
        return cls(
            feature.id,
            T,
            extent - shape.radius,
            shape.radius,
            np.inf if feature.through else depth,
            ends.min(axis=0) - span,
            ends.max(axis=0) + span,
        )

    def outside(self, points: FloatArray) -> FloatArray:
        """How far points (n, 3) of the door frame are from the pocket, shape (n,) [m]; not positive inside."""
        own = self._own(points)
        beside, below = self._beside(own[:, :2]), own[:, 2] - self.depth
        apart = np.hypot(np.maximum(beside, 0.0), np.maximum(below, 0.0))
        found: FloatArray = np.where((beside > 0.0) | (below > 0.0), apart, np.maximum(beside, below))
        return found

    def excess(self, tip: FloatArray, axis: FloatArray, length: float, radius: FloatArray) -> FloatArray:
        """How far cylinders stand out of the pocket and the space before it, shape (n,) [m]; not positive inside.

        Args:
            tip: Middles of the cylinders' front ends, door frame, shape (n, 3) [m].
            axis: Direction in which the cylinders point, door frame, shape (n, 3).
            length: Of the cylinders [m].
            radius: Of the cylinders, shape (n,) [m].
        """
        front, own_axis = self._own(tip), axis @ self.T_door_feature[:3, :3]
        back = front - length * own_axis
        # A tilted disc seen along the feature's axis lies within one of its own radius.
        beside = np.maximum(self._beside(front[:, :2]), self._beside(back[:, :2])) + radius
        tilt = np.sqrt(np.maximum(1.0 - own_axis[:, 2] ** 2, 0.0))
        found: FloatArray = np.maximum(beside, front[:, 2] + radius * tilt - self.depth)
        return found

    def _own(self, points: FloatArray) -> FloatArray:
        own: FloatArray = (points - self.T_door_feature[:3, 3]) @ self.T_door_feature[:3, :3]
        return own

    def _beside(self, points: FloatArray) -> FloatArray:
        """Signed distance of points (n, 2) from the outline, negative inside, shape (n,) [m]."""
        over = np.abs(points) - self.half
        beyond = np.linalg.norm(np.maximum(over, 0.0), axis=1)
        beside: FloatArray = beyond + np.minimum(over.max(axis=1), 0.0) - self.corner
        return beside


@dataclass(frozen=True, eq=False)
class Cuts:
    """Tools in the wood where they may be, in the order of time.

    Attributes:
        place: Places of the path, shape (m,).
        tip: Door frame, shape (m, 3) [m].
        axis: Direction of the tool, door frame, shape (m, 3).
        radius: Shape (m,) [m].
        feature: What was being milled, shape (m,), str.
    """

    place: FloatArray
    tip: FloatArray
    axis: FloatArray
    radius: FloatArray
    feature: NDArray[np.str_]


def still_there(
    pockets: tuple[Pocket, ...], cuts: Cuts, points: FloatArray, place: FloatArray, tolerance: FloatArray
) -> BoolArray:
    """Which points of the door were wood when the path had come to a place.

    Args:
        pockets: Of all features.
        cuts: Tools that took wood of the features.
        points: Inside the door, shape (n, 3) [m].
        place: One for each point, shape (n,).
        tolerance: How far beside a tool wood counts as taken, shape (n,) [m].

    Returns:
        Shape (n,).
    """
    there = np.ones(len(points), dtype=bool)
    for pocket in pockets:
        inside = np.flatnonzero(there & (pocket.outside(points) <= tolerance))
        own = np.flatnonzero(cuts.feature == pocket.feature)
        if not len(inside) or not len(own):
            continue
        for some in np.array_split(inside, len(inside) * len(own) // CHUNK + 1):
            way = points[some, None] - cuts.tip[None, own]  # (k, m, 3)
            along = np.einsum("kmi,mi->km", way, cuts.axis[own])
            beside = np.einsum("kmi,kmi->km", way, way) - along**2
            taken = (along < tolerance[some, None]) & (
                beside < (cuts.radius[own] + tolerance[some, None]) ** 2
            )
            taken &= cuts.place[own] <= place[some, None]
            there[some] = ~taken.any(axis=1)
    return there


def below_surface(points: FloatArray, axis: FloatArray, size: FloatArray) -> FloatArray:
    """Way from points (n, 3) in the door back against directions (n, 3) to the surface, shape (n,) [m].

    Args:
        points: In the door, whose corners are the origin and `size` (3,) [m].
        axis: Unit directions.
        size: Extents of the door [m].
    """
    moving = np.abs(axis) > 1e-9
    to_face = np.where(axis > 0.0, points, size - points) / np.where(moving, np.abs(axis), 1.0)
    way: FloatArray = np.where(moving, to_face, np.inf).min(axis=1)
    return way
