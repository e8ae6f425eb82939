"""One feature as one robot mills it: from which side, how deep, and the contours to follow."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import transform
from doormill_ros.recipes.cutting import Direction
from doormill_ros.recipes.door import R_FEATURE_TOOL, DoorSize, Side
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.outline import Segment
from doormill_ros.toolpath.curves.curve import Curve, Line, arc_about
from doormill_ros.toolpath.errors import ToolFitError
from doormill_ros.units import m_to_mm

LONG = 0.99  #: of the longest straight piece of a contour: others as long will do, too
ROUNDING = 1e-9  #: m; the grid of a recipe is 1 nm
TINY = 1e-7  #: outline segments shorter than this are left out [m]
_NORMAL = np.array([0.0, 0.0, 1.0])
_OTHER_SIDE = {Side.FRONT: Side.REAR, Side.REAR: Side.FRONT}


@dataclass(frozen=True, eq=False)
class Operation:
    """A feature, or one robot's half of a through hole.

    Attributes:
        feature: The recipe's feature.
        side: Surface that the tool enters.
        depth: How deep the tip goes below that surface [m].
        T_door_feature: Frame in that surface, z into the wood, shape (4, 4).
    """

    feature: Feature
    side: Side
    depth: float
    T_door_feature: FloatArray

    @property
    def R_door_tool(self) -> FloatArray:
        """Orientation of the tool, shape (3, 3)."""
        R_door_tool: FloatArray = self.T_door_feature[:3, :3] @ R_FEATURE_TOOL
        return R_door_tool

    def point(self, xy: FloatArray, depth: float) -> FloatArray:
        """Point of the feature in the door frame, shape (3,) [m]."""
        T = self.T_door_feature
        place: FloatArray = T[:3, :3] @ np.array([xy[0], xy[1], depth]) + T[:3, 3]
        return place

    def contour(self, inset: float, depth: float, corner: float = 0.0) -> list[tuple[Curve, str]]:
        """Closed contour in the door frame with the recipe's segment names.

        Climb milling is the default: the tool then runs clockwise in the feature's plane, seen
        from inside the wood. The edge enters the wood at full chip and leaves it at none, which
        takes the heat away with the chips and leaves the better wall (thesis, sections 2.5 and
        3.9); its drag into the wood, against which the thesis warns, is what the correction is for.

        Args:
            inset: How far inside the finished wall [m].
            depth: Depth of the tip [m].
            corner: Smallest radius of its corners, as far as there is room for it [m].
        """
        outline = self.feature.outline(inset, corner)
        pieces = [
            (_curve(segment, depth).mapped(self.T_door_feature), segment.name)
            for segment in outline.segments
            if segment.length > TINY
        ]
        if self.feature.direction is Direction.CLIMB:
            return pieces
        return [(curve.backwards(), name) for curve, name in reversed(pieces)]


@functools.lru_cache(maxsize=128)  # so that whoever works on one and the same finds what he made of it
def operation(feature: Feature, door: DoorSize, half: bool = False, far_side: bool = False) -> Operation:
    """A feature as one robot mills it.

    Args:
        feature: The recipe's feature.
        door: Size of the door.
        half: Mill a through hole half-way only, because another robot mills the other half.
        far_side: Enter a through hole from the side opposite to the recipe's.

    Raises:
        ToolFitError: The tool cuts one half of a hole, and is to mill all of it.
    """
    T_door_feature, side = feature.T_door_feature(door), feature.side
    if far_side:
        # Half a turn about the feature's y axis at the exit of the hole.
        turn = transform(np.diag([-1.0, 1.0, -1.0]), np.array([0.0, 0.0, feature.cut_depth(door)]))
        T_door_feature, side = T_door_feature @ turn, _OTHER_SIDE[side]
    depth, tool = feature.tip_depth(door, half), feature.tool
    if feature.through and depth > tool.cutting_length + ROUNDING:
        raise ToolFitError(
            f"{feature.id}: {tool.name} cuts {m_to_mm(tool.cutting_length):g} mm deep, allowed for all of the hole "
            f"are at least {m_to_mm(depth):g} mm; choose a longer tool, or let a second robot mill the other half",
            feature=feature.id,
        )
    return Operation(feature, side, depth, T_door_feature)


def from_longest_line(pieces: list[tuple[Curve, str]], ahead: float = 0.0) -> list[tuple[Curve, str]]:
    """The closed contour, starting on its longest straight piece (or on any arc).

    Args:
        pieces: The contour.
        ahead: How far past the middle of that piece, as far as three quarters of it [m].
    """
    lengths = [0.0 if curve.is_arc else curve.length for curve, _ in pieces]
    first = int(np.argmax(lengths))
    curve, _ = pieces[first]
    return _starting(pieces, first, min(0.5 + ahead / curve.length, 0.75))


def from_line_near(
    pieces: list[tuple[Curve, str]], at: FloatArray, ahead: float = 0.0
) -> list[tuple[Curve, str]]:
    """The closed contour, starting ahead of a place on one of its longest straight pieces, in their middle half.

    Args:
        pieces: The contour.
        at: Where the tool comes from, shape (3,) [m].
        ahead: How far ahead of it, along the piece [m].
    """
    longest = max((curve.length for curve, _ in pieces if not curve.is_arc), default=0.0)
    best, chosen = math.inf, (0, 0.5)
    for i, (curve, _) in enumerate(pieces):
        if curve.is_arc or curve.length < LONG * longest:
            continue
        wanted = float((at - curve.start) @ curve.tangent(0.0)) + ahead
        share = min(max(wanted / curve.length, 0.25), 0.75)
        # Where the middle half is left, the tool would have to turn back.
        missed = abs(wanted - share * curve.length) + math.dist(at, curve.point(share))
        if missed < best:
            best, chosen = missed, (i, share)
    return from_longest_line(pieces) if math.isinf(best) else _starting(pieces, *chosen)


def _starting(pieces: list[tuple[Curve, str]], first: int, share: float) -> list[tuple[Curve, str]]:
    curve, name = pieces[first]
    head: tuple[Curve, str] = (curve.part(0.0, share), name)
    tail: tuple[Curve, str] = (curve.part(share, 1.0), name)
    return [tail, *pieces[first + 1 :], *pieces[:first], head]


def _curve(segment: Segment, depth: float) -> Curve:
    start, end = np.array([*segment.start, depth]), np.array([*segment.end, depth])
    if segment.centre is None:
        return Line(start, end)
    arc = arc_about(start, np.array([*segment.centre, depth]), _NORMAL, segment.angle)
    return replace(arc, end=end)
