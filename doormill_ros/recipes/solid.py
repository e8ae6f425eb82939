"""The wood that a feature takes away, as a prism in the door frame, and how near two of them are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from doormill_ros.frames import apply
from doormill_ros.recipes.door import DoorSize
from doormill_ros.recipes.features.base import Feature


@dataclass(frozen=True, eq=False)
class Prism:
    """The outline of a feature drawn out along x or y of the door frame.

    Attributes:
        feature: The feature.
        door: Size of its door.
        axis: 0 for x (face features), 1 for y (edge features).
        low: Start along the axis [m].
        high: End along the axis [m].
    """

    feature: Feature
    door: DoorSize
    axis: int
    low: float
    high: float

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """Cross-section [m]; its first coordinate is the other of x and y, its second z."""
        points = self.feature.outline().points(step=math.inf, chord_error=1e-5)
        corners = apply(
            self.feature.T_door_feature(self.door), np.column_stack([points, np.zeros(len(points))])
        )
        return shapely.Polygon(corners[:, [1 - self.axis, 2]])

    @cached_property
    def box(self) -> tuple[tuple[float, float], ...]:
        """Extent along x, y and z of the door frame [m]."""
        shape, centre = self.feature.shape, self.feature.across(self.door)
        across = (centre - shape.width / 2.0, centre + shape.width / 2.0)
        height = float(self.feature.T_door_feature(self.door)[2, 3])
        along = (self.low, self.high)
        first = (along, across) if self.axis == 0 else (across, along)
        return (*first, (height - shape.length / 2.0, height + shape.length / 2.0))

    def meets(self, other: Prism, wall: float = 0.0) -> bool:
        """True when the two share some wood, or leave less than `wall` [m] between them."""
        for (low, high), (other_low, other_high) in zip(self.box, other.box, strict=True):
            if other_low >= high + wall or low >= other_high + wall:
                return False
        mine = self.polygon.buffer(wall) if wall > 0.0 else self.polygon
        if self.axis == other.axis:
            return bool(mine.intersection(other.polygon).area > 0.0)
        # At a height z both are rectangles in x and y: each one's extent along the other's axis
        # must be met there, so the heights at which the first and the second condition hold
        # must overlap.
        mine = _heights(mine, other.low, other.high)
        theirs = _heights(other.polygon, self.low - wall, self.high + wall)
        return any(min(a[1], b[1]) > max(a[0], b[0]) for a in mine for b in theirs)


def prism(feature: Feature, door: DoorSize) -> Prism:
    """The wood that the finished feature takes away."""
    T_door_feature = feature.T_door_feature(door)
    axis = 1 if feature.side.is_edge else 0
    start = float(T_door_feature[axis, 3])
    end = start + feature.cut_depth(door) * float(T_door_feature[axis, 2])
    return Prism(feature, door, axis, min(start, end), max(start, end))


def _heights(polygon: shapely.Polygon, low: float, high: float) -> list[tuple[float, float]]:
    """Ranges of z in which the polygon reaches into low..high of its first coordinate."""
    _, bottom, _, top = polygon.bounds
    cut = polygon.intersection(shapely.box(low, bottom - 1.0, high, top + 1.0))
    parts = [part for part in getattr(cut, "geoms", [cut]) if part.area > 0.0]
    return [(part.bounds[1], part.bounds[3]) for part in parts]
