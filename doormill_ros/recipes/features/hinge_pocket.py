"""Hinge pockets on the face: the thesis' oblong, and the rectangle for a hinge leaf."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import ClassVar

import numpy as np

from doormill_ros.recipes.door import DoorSize, Side
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.fields import Choice, Quantity, entry
from doormill_ros.recipes.outline import RoundedRectangle


class OutlinePoints(Enum):
    """How many points the thesis uses for an oblong (figure 3.24)."""

    SIX = 6
    NINE = 9


@dataclass(frozen=True, kw_only=True)
class HingePocket(Feature):
    """A pocket for a hinge, near the hinge edge.

    Attributes:
        backset: Distance of the centre from the hinge edge [m].
        width: Extent across the door [m].
        length: Extent along the height [m].
        depth: Depth [m].
    """

    sides: ClassVar[tuple[Side, ...]] = (Side.FRONT, Side.REAR)

    backset: float = entry(Quantity("mm", 0.0, 1350.0))
    width: float = entry(Quantity("mm", 5.0, 300.0))
    length: float = entry(Quantity("mm", 5.0, 600.0))
    depth: float = entry(Quantity("mm", 0.5, 60.0))

    def across(self, door: DoorSize) -> float:
        """See the base class."""
        return self.backset

    def cut_depth(self, door: DoorSize) -> float:
        """See the base class."""
        return self.depth


@dataclass(frozen=True, kw_only=True)
class OblongHinge(HingePocket):
    """The outline of the thesis: two straight lines joined by two half-turns.

    Attributes:
        points: Six or nine points a contour; see `point_positions`.
    """

    kind: ClassVar[str] = "hinge_oblong"

    points: OutlinePoints = entry(Choice(OutlinePoints), default=OutlinePoints.SIX)

    @property
    def shape(self) -> RoundedRectangle:
        """See the base class."""
        return RoundedRectangle(self.width, self.length, min(self.width, self.length) / 2.0)

    @property
    def split_lines(self) -> bool:
        """See the base class."""
        return self.points is OutlinePoints.NINE

    def point_positions(self, inset: float = 0.0) -> np.ndarray:
        """The numbered points of the contour, shape (6, 2) or (9, 2) [m], feature frame.

        Six points, in the thesis' numbering 10 to 15 (figures 3.24b and 3.41): top of the top
        turn, top left, top right, bottom left, bottom right, bottom of the bottom turn. The path
        is 11, 10, 12, 14, 15, 13, 11. The print of figure 3.24a does not give its nine points
        away; here they are 10 top, 11 and 12 upper left and right, 13 and 14 the middles of
        the lines, 15 and 16 lower left and right, 17 bottom, and 18 where the contour closes
        on 11 (a point of its own because it is reached under the wrench of the left line).

        Args:
            inset: How far inside the finished wall [m].
        """
        segments = self.outline(inset).segments
        top, bottom = (next(s for s in segments if s.name == name) for name in ("top_turn", "bottom_turn"))
        if self.points is OutlinePoints.SIX:
            chosen = [top.via, top.start, top.end, bottom.end, bottom.start, bottom.via]
        else:
            right, left = (next(s for s in segments if s.name == n) for n in ("right_line", "left_line"))
            ends = [bottom.end, bottom.start, bottom.via, segments[-1].end]
            chosen = [top.via, top.start, top.end, left.end, right.end, *ends]
        return np.array(chosen)


@dataclass(frozen=True, kw_only=True)
class LeafHinge(HingePocket):
    """A rectangular pocket for a hinge leaf.

    Attributes:
        corner_radius: Radius of the four corners [m].
    """

    kind: ClassVar[str] = "hinge_leaf"

    corner_radius: float = entry(Quantity("mm", 0.0, 100.0))

    @property
    def shape(self) -> RoundedRectangle:
        """See the base class."""
        return RoundedRectangle(self.width, self.length, self.corner_radius)
