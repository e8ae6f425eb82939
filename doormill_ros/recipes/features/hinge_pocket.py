"""Hinge pockets on the face: the thesis' oblong, and the rectangle for a hinge leaf."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any, ClassVar

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.recipes.door import DoorSize, Side
from doormill_ros.recipes.errors import OutOfRange, WrongType
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.fields import Choice, Codec, Quantity, entry, join
from doormill_ros.recipes.outline import RoundedRectangle
from doormill_ros.units import MM


class OutlinePoints(Enum):
    """How many points the thesis uses for an oblong (figure 3.24)."""

    SIX = 6
    NINE = 9


@dataclass(frozen=True)
class PointPairs(Codec):
    """Codec of a list of pairs [y, z] in millimetres."""

    LIMIT: ClassVar[float] = 5.0

    def key(self, name: str) -> str:
        """See the base class."""
        return f"{name}_mm"

    def read(self, value: Any, path: str, context: Mapping[str, Any]) -> tuple[tuple[float, float], ...]:
        """See the base class."""
        if not isinstance(value, list | tuple):
            raise WrongType(path, f"found {value!r:.80}, allowed is a list of pairs [y, z]", found=value)
        single = Quantity("mm", -self.LIMIT, self.LIMIT)
        pairs = []
        for index, pair in enumerate(value):
            where = join(path, index)
            if not isinstance(pair, list | tuple) or len(pair) != 2:
                raise WrongType(where, f"found {pair!r:.80}, allowed is a pair [y, z]", found=pair)
            pairs.append(tuple(single.read(cell, join(where, i), context) for i, cell in enumerate(pair)))
        return tuple(pairs)

    def load(self, value: Any, context: Mapping[str, Any]) -> tuple[tuple[float, float], ...]:
        """See the base class."""
        return tuple(tuple(cell * MM for cell in pair) for pair in value)

    def write(self, value: tuple[tuple[float, float], ...]) -> list[list[float]]:
        """See the base class."""
        single = Quantity("mm", -self.LIMIT, self.LIMIT)
        return [[single.write(cell) for cell in pair] for pair in value]


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
        force_displacement: (y, z) compensation of each point [m] that came with the door's data
            (thesis section 3.8), or None. Kept as a record: paths are corrected by the robot model.
    """

    kind: ClassVar[str] = "hinge_oblong"

    points: OutlinePoints = entry(Choice(OutlinePoints), default=OutlinePoints.SIX)
    force_displacement: tuple[tuple[float, float], ...] | None = entry(PointPairs(), default=None)

    @staticmethod
    def check_fields(values: dict[str, Any], path: str) -> None:
        """A force displacement has one pair a point; raises OutOfRange."""
        pairs = values.get("force_displacement")
        count = values.get("points", OutlinePoints.SIX).value
        if pairs is not None and len(pairs) != count:
            raise OutOfRange(
                join(path, "force_displacement_mm"),
                f"found {len(pairs)} pairs, allowed are {count}, one for each point of the contour",
                found=len(pairs),
            )

    @property
    def shape(self) -> RoundedRectangle:
        """See the base class."""
        return RoundedRectangle(self.width, self.length, min(self.width, self.length) / 2.0)

    @property
    def split_lines(self) -> bool:
        """See the base class."""
        return self.points is OutlinePoints.NINE

    def point_positions(self, inset: float = 0.0) -> FloatArray:
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
