"""Ways down into the wood that a mill without an edge over its centre can go: along a contour, at a slope."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.toolpath.curves.curve import Curve, Line, arc_through

Pieces = Sequence[tuple[Curve, str]]
SHORT = 0.005  #: pieces of a straight line that are left or begun are longer than this, if the line is [m]
GENTLER = 0.15  #: of a lap: so much longer may the ramps of a feature get
NEAR = 1e-9  #: two places are one [m]


@dataclass(frozen=True, eq=False)
class Descent:
    """A way down along a closed contour, and the contour from there.

    Attributes:
        ramp: Down to the contour's plane, one after the other.
        lap: The whole contour from where the ramp ends, with the names of its segments.
        slope: Of the ramp [rad].
    """

    ramp: tuple[Curve, ...]
    lap: tuple[tuple[Curve, str], ...]
    slope: float


def descent(
    pieces: Pieces, at: FloatArray, drop: float, slope: float, inward: FloatArray, *, arriving: bool = False
) -> Descent:
    """Down to a closed contour, along it.

    The ramp begins over `at` where that lies on the contour, else over its first point, or ends there, and goes round
    as often as it takes. The arcs of a helix become those that a MoveC makes of three of its points: they lie inside.

    Args:
        pieces: The contour at its depth, arcs no longer than half a turn.
        at: Where the tool stands, shape (3,) [m].
        drop: How far over the contour the ramp begins [m].
        slope: Steepest allowed [rad].
        inward: Unit direction into the wood, shape (3,).
        arriving: True for a ramp that ends at the first point.
    """
    lengths = [curve.length for curve, _ in pieces]
    lap, needed = sum(lengths), drop / math.tan(slope)
    flat = at + ((pieces[0][0].start - at) @ inward) * inward
    start = _place_of(pieces, flat)
    on = 0.0 if start is None else start
    if arriving and start is None and not pieces[0][0].is_arc:
        # Gone down from there backwards: the contour the other way round is worth as much.
        backwards = [(curve.backwards(), name) for curve, name in reversed(pieces)]
        way = _way_of(backwards, 0.0, needed)
        on = -way % lap
    elif pieces[0][0].is_arc and start is None:
        way = _way_of(pieces, on, needed, lengths[0])  # whole arcs
    else:
        # What would be left of a piece is gone down too.
        way = _rounded_up(lengths, on, _way_of(pieces, on, needed))
    parts = [curve for curve, _ in _stretch(pieces, on, way)]
    level = np.concatenate([[0.0], np.cumsum([_advance(curve) for curve in parts])])
    height = drop * (1.0 - level / level[-1])
    ramp = [_raised(c, a, b, inward) for c, a, b in zip(parts, height[:-1], height[1:], strict=True)]
    rest = _stretch(pieces, (on + way) % lap, lap)
    return Descent(tuple(ramp), tuple(rest), math.atan2(drop, float(level[-1])))


def _advance(curve: Curve) -> float:
    """What a curve is worth going down: an arc of a MoveC is steepest in its middle, where it goes along its chord."""
    return math.dist(curve.start, curve.end)


def _way_of(pieces: Pieces, start: float, needed: float, step: float = 0.0) -> float:
    """The shortest way that is worth what is needed, or a multiple of the step that is [m]."""
    lap, gained = sum(curve.length for curve, _ in pieces), sum(_advance(curve) for curve, _ in pieces)
    # Whole laps first: what is left takes few looks.
    whole = max(0.0, needed // gained - 1.0) * lap
    needed -= whole / lap * gained
    return whole + _looked_for(pieces, start, needed, step)


def _looked_for(pieces: Pieces, start: float, needed: float, step: float) -> float:
    way = step or needed
    while (worth := _worth(pieces, start, way)) < needed - NEAR:
        way += step or max(needed - worth, SHORT)
    return way


def _worth(pieces: Pieces, start: float, way: float) -> float:
    return sum(_advance(curve) for curve, _ in _stretch(pieces, start, way))


def centred(pieces: Pieces, drops: Sequence[float], slope: float, beyond: float) -> tuple[FloatArray, float]:
    """Where descents one after the other begin, and their slope, so that they begin and end near the first point.

    The robot comes to that height and leaves from it. Half a lap further on is as good, so the slope is made somewhat
    less steep where they come to lie there; else begin and end lie equally far from it.

    Args:
        pieces: The contour.
        drops: How far each goes down [m].
        slope: Steepest allowed [rad].
        beyond: What comes behind the last one [m].

    Returns:
        Place on the contour, shape (3,) [m], and slope [rad].
    """
    lap = sum(curve.length for curve, _ in pieces)
    run = sum(drops) / math.tan(slope)
    even = math.ceil((run + beyond) / (0.5 * lap) - NEAR) * 0.5 * lap - beyond
    if even - run <= GENTLER * lap:
        return pieces[0][0].start, math.atan(sum(drops) / even)
    drift = (run + beyond + 0.25 * lap) % (0.5 * lap) - 0.25 * lap
    first, _ = next(_stretch(pieces, -0.5 * drift % lap, lap))
    return first.start, slope


def straight_descent(
    end: FloatArray, tangent: FloatArray, drop: float, slope: float, inward: FloatArray
) -> Line:
    """Straight down to a point along a direction.

    Args:
        end: Shape (3,) [m].
        tangent: Unit direction of travel at the depth, shape (3,).
        drop: How far over the point it begins [m].
        slope: Of the line [rad].
        inward: Unit direction into the wood, shape (3,).
    """
    return Line(end - drop / math.tan(slope) * tangent - drop * inward, end)


def head_room(before: FloatArray, ramp: Curve, leg: float, inward: FloatArray) -> float:
    """How far over the floor a ramp has to begin so that the corner into it is flown by over the floor [m].

    A corner is flown by on a parabola. Up to a right angle, seen along `inward`, no part of it is steeper than the
    ramp; where the tool turns back, it goes down where it goes no way along, and that must not be in the wood.

    Args:
        before: Direction in which the tool comes, along the floor, shape (3,).
        ramp: What it turns into.
        leg: How far behind the corner the parabola ends [m].
        inward: Unit direction into the wood, shape (3,).
    """
    into = ramp.tangent(0.0)
    down = float(into @ inward)
    return leg * down if float(before @ (into - down * inward)) < -NEAR else 0.0


def _raised(curve: Curve, begin: float, end: float, inward: FloatArray) -> Curve:
    """The curve with its begin and its end that far above its plane [m]."""
    first, last = curve.start - begin * inward, curve.end - end * inward
    if not curve.is_arc:
        return Line(first, last)
    return arc_through(first, curve.point(0.5) - 0.5 * (begin + end) * inward, last)


def _place_of(pieces: Pieces, point: FloatArray) -> float | None:
    """Way along the contour to a point of it [m]; None for another."""
    gone = 0.0
    for curve, _ in pieces:
        if isinstance(curve, Line):
            along = float((point - curve.start) @ curve.tangent(0.0))
            on = curve.start + along * curve.tangent(0.0)
            if -NEAR < along < curve.length - NEAR and math.dist(on, point) < NEAR:
                return gone + max(along, 0.0)
        elif math.dist(curve.start, point) < NEAR:
            return gone
        gone += curve.length
    return None


def _rounded_up(lengths: Sequence[float], start: float, way: float) -> float:
    """A way [m] from a place of the contour that leaves no short piece behind its end, or before it."""
    lap = sum(lengths)
    ends = np.cumsum(lengths)
    at = (start + way) % lap
    piece = min(int(np.searchsorted(ends, at)), len(lengths) - 1)
    left, begun = float(ends[piece]) - at, at - float(ends[piece]) + lengths[piece]
    if lengths[piece] < 2.0 * SHORT or left < SHORT:
        return way + left
    begun = min(begun, way)
    return way + max(0.0, SHORT - begun) if begun < SHORT else way


def _stretch(pieces: Pieces, start: float, way: float) -> Iterator[tuple[Curve, str]]:
    """The parts of a closed contour from a place on it [m], for a way [m] that may be several laps."""
    index, left = 0, start
    while left > pieces[index][0].length - NEAR:
        left -= pieces[index][0].length
        index = (index + 1) % len(pieces)
        if left <= NEAR:
            left = 0.0
            break
    while way > NEAR:
        curve, name = pieces[index]
        length = curve.length
        last = min(left + way, length)
        whole = left <= NEAR and length - last <= NEAR
        yield (curve if whole else curve.part(left / length, last / length)), name
        way -= last - left
        left, index = 0.0, (index + 1) % len(pieces)
