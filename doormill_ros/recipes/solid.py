"""The wood that a feature takes away, as a prism in the door frame, and how near two of them are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from doormill_ros.frames import apply
from doormill_ros.recipes.door import DoorSize
from doormill_ros.recipes.features.base import Feature


@dataclass(frozen=True, eq=False)
class Prism:
    """A polygon drawn out along x or y of the door frame.

    Attributes:
        axis: 0 for x (face features), 1 for y (edge features).
        polygon: Cross-section; its first coordinate is the other of x and y, its second z [m].
        low: Start along the axis [m].
        high: End along the axis [m].
    """

    axis: int
    polygon: shapely.Polygon
    low: float
    high: float

    def grown(self, distance: float) -> Prism:
        """The prism with `distance` [m] more on every side."""
        polygon = self.polygon.buffer(distance)
        return Prism(self.axis, polygon, self.low - distance, self.high + distance)

    def meets(self, other: Prism) -> bool:
        """True when the two share some wood."""
        if self.axis == other.axis:
            overlap = min(self.high, other.high) > max(self.low, other.low)
            return overlap and self.polygon.intersection(other.polygon).area > 0.0
        # At a height z both are rectangles in x and y: each one's extent along the other's axis
        # must be met there, so the heights at which the first and the second condition hold
        # must overlap.
        mine = _heights(self.polygon, other.low, other.high)
        theirs = _heights(other.polygon, self.low, self.high)
        return any(min(a[1], b[1]) > max(a[0], b[0]) for a in mine for b in theirs)


def prism(feature: Feature, door: DoorSize) -> Prism:
    """The wood that the finished feature takes away."""
    T_door_feature = feature.T_door_feature(door)
    points = feature.outline().points(step=math.inf, chord_error=1e-5)
    depth = feature.cut_depth(door)
    corners = apply(T_door_feature, np.column_stack([points, np.zeros(len(points))]))
    axis = 1 if feature.side.is_edge else 0
    start = float(T_door_feature[axis, 3])
    end = start + depth * float(T_door_feature[axis, 2])
    polygon = shapely.Polygon(corners[:, [1 - axis, 2]])
    return Prism(axis, polygon, min(start, end), max(start, end))


def _heights(polygon: shapely.Polygon, low: float, high: float) -> list[tuple[float, float]]:
    """Ranges of z in which the polygon reaches into low..high of its first coordinate."""
    _, bottom, _, top = polygon.bounds
    cut = polygon.intersection(shapely.box(low, bottom - 1.0, high, top + 1.0))
    parts = [part for part in getattr(cut, "geoms", [cut]) if part.area > 0.0]
    return [(part.bounds[1], part.bounds[3]) for part in parts]
