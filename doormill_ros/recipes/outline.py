"""Outlines of pockets: closed contours of straight lines and circular arcs."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
import shapely

from doormill_ros.arrays import FloatArray

Point = tuple[float, float]  #: x, y in the feature's plane [m]
HALF_SQRT2 = math.sqrt(0.5)


@dataclass(frozen=True)
class Segment:
    """One line or arc of an outline, in the feature's xy plane.

    Attributes:
        name: Name by which the recipe gives its wrench, for example "left_line" or "top_turn".
        start: First point (x, y) [m].
        end: Last point (x, y) [m].
        via: Point half-way along an arc (x, y) [m]; None for a line.
        centre: Centre of an arc (x, y) [m]; None for a line.
    """

    name: str
    start: Point
    end: Point
    via: Point | None = None
    centre: Point | None = None

    @property
    def is_arc(self) -> bool:
        """True for an arc."""
        return self.via is not None

    @property
    def radius(self) -> float:
        """Radius of an arc [m]; infinite for a line."""
        return math.dist(self.start, self.centre) if self.centre else math.inf

    @property
    def angle(self) -> float:
        """Signed angle turned through [rad], negative for clockwise; 0 for a line."""
        if self.centre is None or self.via is None:
            return 0.0
        return 2.0 * _turn(self.centre, self.start, self.via)

    @property
    def length(self) -> float:
        """Length along the segment [m]."""
        return abs(self.angle) * self.radius if self.is_arc else math.dist(self.start, self.end)

    def points(self, fraction: FloatArray) -> FloatArray:
        """Points, shape (n, 2) [m], at the given fractions, shape (n,), of the length."""
        fraction = np.asarray(fraction, dtype=float)
        if self.centre is None:
            return np.outer(1.0 - fraction, self.start) + np.outer(fraction, self.end)
        first = math.atan2(self.start[1] - self.centre[1], self.start[0] - self.centre[0])
        angles = first + fraction * self.angle
        return np.array(self.centre) + self.radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)


@dataclass(frozen=True)
class Outline:
    """A closed contour; each segment starts where the one before it ends.

    Outlines run clockwise in the feature's xy plane, seen with x to the right and y up. The
    feature's z axis, which points into the wood, points at that observer, so the spindle, which
    turns clockwise seen along the tool axis, turns anticlockwise there: running clockwise round
    the inside of a wall is climb milling.
    """

    segments: tuple[Segment, ...]

    @property
    def length(self) -> float:
        """Length once round [m]."""
        return sum(segment.length for segment in self.segments)

    def points(self, step: float = 1e-3, chord_error: float = 1e-5) -> FloatArray:
        """Points along the outline, first one not repeated, shape (n, 2) [m].

        Args:
            step: Largest distance between points [m].
            chord_error: Largest distance between an arc and its chords [m].
        """
        parts = []
        for segment in self.segments:
            count = max(1, math.ceil(segment.length / step))
            if segment.is_arc:
                turn = 2.0 * math.acos(max(0.0, 1.0 - chord_error / max(segment.radius, chord_error)))
                count = max(count, math.ceil(abs(segment.angle) / max(turn, 1e-3)))
            parts.append(segment.points(np.arange(count) / count))
        return np.concatenate(parts)

    def polygon(self, chord_error: float = 1e-5) -> shapely.Polygon:
        """The enclosed area as a polygon; arcs become chords within `chord_error` [m]."""
        return shapely.Polygon(self.points(step=math.inf, chord_error=chord_error))


@dataclass(frozen=True)
class RoundedRectangle:
    """The shape of every feature so far: a rectangle with round corners about the origin.

    An oblong has a corner radius of half its width, a round hole also a length equal to its
    width. The offset of such a shape is again one, with arcs that stay arcs.

    Attributes:
        width: Extent along x [m].
        length: Extent along y [m].
        radius: Corner radius [m].
    """

    width: float
    length: float
    radius: float

    def inset(self, distance: float) -> RoundedRectangle:
        """The shape whose boundary lies `distance` [m] further inside.

        Raises:
            ValueError: The shape is not wide enough.
        """
        width, length = self.width - 2.0 * distance, self.length - 2.0 * distance
        if min(width, length) < 0.0:
            raise ValueError(f"an inset of {distance} m leaves nothing of {self}")
        radius = self.radius - distance
        tiny = 1e-9
        return RoundedRectangle(
            width, length, 0.0 if radius < tiny else min(radius, width / 2.0, length / 2.0)
        )

    def rounded(self, radius: float) -> RoundedRectangle:
        """The shape with corners of this radius at least, as far as there is room for it [m]."""
        room = min(self.width, self.length) / 2.0
        return RoundedRectangle(self.width, self.length, max(self.radius, min(radius, room)))

    @functools.lru_cache(maxsize=1024)  # noqa: B019 - shapes are small, frozen, and asked again and again
    def outline(self, split_lines: bool = False) -> Outline:
        """The contour, clockwise from the left end of the top turn or of the top left corner.

        Args:
            split_lines: Divide the left and the right line in the middle.
        """
        x, y, r = self.width / 2.0, self.length / 2.0, self.radius
        lines = functools.partial(_line, split=split_lines)
        tiny = 1e-9
        if abs(r - x) < tiny:  # oblong along y: half-turns at top and bottom
            c = y - r
            parts = [
                _arc("top_turn", (-x, c), (0.0, y), (x, c), (0.0, c)),
                *lines("right_line", (x, c), (x, -c)),
                _arc("bottom_turn", (x, -c), (0.0, -y), (-x, -c), (0.0, -c)),
                *lines("left_line", (-x, -c), (-x, c)),
            ]
        else:
            a, b, k = x - r, y - r, r * HALF_SQRT2
            parts = [
                _arc("top_left_corner", (-x, b), (-a - k, b + k), (-a, y), (-a, b)),
                *_line("top_line", (-a, y), (a, y)),
                _arc("top_right_corner", (a, y), (a + k, b + k), (x, b), (a, b)),
                *lines("right_line", (x, b), (x, -b)),
                _arc("bottom_right_corner", (x, -b), (a + k, -b - k), (a, -y), (a, -b)),
                *_line("bottom_line", (a, -y), (-a, -y)),
                _arc("bottom_left_corner", (-a, -y), (-a - k, -b - k), (-x, -b), (-a, -b)),
                *lines("left_line", (-x, -b), (-x, b)),
            ]
        return Outline(tuple(part for part in parts if part.length > tiny))


def _turn(centre: Point, start: Point, end: Point) -> float:
    """Signed angle [rad], under half a turn, from one point to another seen from a centre."""
    a, b = ((p[0] - centre[0], p[1] - centre[1]) for p in (start, end))
    return math.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1])


def _arc(name: str, start: Point, via: Point, end: Point, centre: Point) -> Segment:
    return Segment(name, start, end, via, centre)


def _line(name: str, start: Point, end: Point, split: bool = False) -> list[Segment]:
    if not split or math.dist(start, end) == 0.0:
        return [Segment(name, start, end)]
    middle = ((start[0] + end[0]) / 2.0, (start[1] + end[1]) / 2.0)
    return [Segment(name, start, middle), Segment(name, middle, end)]
