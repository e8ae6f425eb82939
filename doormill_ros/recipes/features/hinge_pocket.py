"""Hinge pockets on the face: the thesis' oblong, and the rectangle for a hinge leaf."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import GetCoreSchemaHandler, model_validator
from pydantic_core import CoreSchema

from doormill_ros.arrays import FloatArray
from doormill_ros.recipes.door import DoorSize, Side
from doormill_ros.recipes.errors import OutOfRange, WrongType
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.features.time_budget import TimeBudget
from doormill_ros.recipes.outline import RoundedRectangle
from doormill_ros.recipes.quantities import (
    Choice,
    Quantity,
    complaint,
    schema,
)


class OutlinePoints(Choice):
    """How many points the thesis uses for an oblong (figure 3.24)."""

    SIX = 6
    NINE = 9


class PointPairs:
    """Annotation of pairs (y, z) [m], in the document a list of pairs [y, z] in millimetres."""

    single = Quantity("mm", -5.0, 5.0)

    def key(self, name: str) -> str:
        """Name in the document."""
        return self.single.key(name)

    def read(self, value: Any) -> tuple[tuple[float, float], ...]:
        """The pairs; raises `complaint`."""
        if not isinstance(value, list | tuple):
            raise complaint(WrongType, f"found {value!r:.80}, allowed is a list of pairs [y, z]", found=value)
        for index, pair in enumerate(value):
            if not isinstance(pair, list | tuple) or len(pair) != 2:
                raise complaint(
                    WrongType, f"found {pair!r:.80}, allowed is a pair [y, z]", (index,), found=pair
                )
        return tuple((self._cell(i, 0, y), self._cell(i, 1, z)) for i, (y, z) in enumerate(value))

    def _cell(self, index: int, column: int, value: Any) -> float:
        return self.single.read(value, (index, column))

    def write(self, value: tuple[tuple[float, float], ...]) -> list[list[float]]:
        """The document's list."""
        return [[self.single.write(cell) for cell in pair] for pair in value]

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return schema(source, self.read, self.write)


@dataclass(frozen=True, kw_only=True)
class HingePocket(Feature):
    """A pocket for a hinge, near the hinge edge.

    Attributes:
        backset: Distance of the centre from the hinge edge [m].
        width: Extent across the door [m].
        length: Extent along the height [m].
        depth: Depth [m].
    """

    budget: ClassVar[TimeBudget | None] = TimeBudget("hinges", "{count} hinges")
    sides: ClassVar[tuple[Side, ...]] = (Side.FRONT, Side.REAR)
    across_key: ClassVar[str] = "backset_mm"
    depth_key: ClassVar[str] = "depth_mm"

    backset: Annotated[float, Quantity("mm", 0.0, 1350.0)]
    width: Annotated[float, Quantity("mm", 5.0, 300.0)]
    length: Annotated[float, Quantity("mm", 5.0, 600.0)]
    depth: Annotated[float, Quantity("mm", 0.5, 60.0)]

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

    points: OutlinePoints = OutlinePoints.SIX
    force_displacement: Annotated[tuple[tuple[float, float], ...] | None, PointPairs()] = None

    @model_validator(mode="after")
    def _one_pair_a_point(self) -> OblongHinge:
        pairs, count = self.force_displacement, self.points.value
        if pairs is not None and len(pairs) != count:
            raise complaint(
                OutOfRange,
                f"found {len(pairs)} pairs, allowed are {count}, one for each point of the contour",
                ("force_displacement_mm",),
                found=len(pairs),
            )
        return self

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
    radius_key: ClassVar[str] = "corner_radius_mm"

    corner_radius: Annotated[float, Quantity("mm", 0.0, 100.0)]

    @property
    def shape(self) -> RoundedRectangle:
        """See the base class."""
        return RoundedRectangle(self.width, self.length, self.corner_radius)
