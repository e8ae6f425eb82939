"""A strip between two lines that run along an edge: how bright it is, and where it ends at the other edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.search.shade import PITCH, WELL, Surfaces
from doormill_ros.statistics import median

LEAST = 5.0  #: grey levels between two surfaces of which the border can be placed
ACROSS = np.linspace(0.3, 0.7, 5)  #: where across a strip it is read, as shares of its width
_TWO_SIDES = np.array([[0.15, 0.25, 0.35], [0.65, 0.75, 0.85]])  # the same, near its outer and inner line
BEYOND = -6.0e-3  #: from so far beyond the other edge's outermost line a strip's end is looked for [m],
_WITHIN = 4.0e-3  # to so far within the innermost [m]
# Where a strip's width is read along the edge, from the corner; how far beside each line, and how closely [m]
_READ, _NEAR, _FINE = (4.0e-3, 32.0e-3), 0.6e-3, 0.03e-3
_SMOOTH = 5  # differences that are averaged
_RISE = 0.15  # a strip begins where it differs so much from what lies beyond, as a share of its difference


@dataclass(frozen=True)
class EdgeStrip:
    """What lies between two lines of one edge.

    Attributes:
        level: Its brightness [grey levels].
        end: Where it ends along the edge, seen from beyond [m]; None where that cannot be told.
        left: The same, seen from inside [m]; inf where it is not there at the corner.
        middle: Across the edge [m].
    """

    level: float
    end: float | None
    left: float
    middle: float


def read_strip(
    sight: Surfaces, edge: str, inner: EdgeLine, outer: EdgeLine, corner: float, across_lines: list[EdgeLine]
) -> EdgeStrip:
    """What lies between two lines of an edge.

    Args:
        sight: The picture.
        edge: "hinge" or "bottom".
        inner: The line inside of it.
        outer: The line outside of it.
        corner: Where the edge meets the other one [m].
        across_lines: Lines of the other edge, from the inside outwards.
    """
    low, high = outer.at(corner), inner.at(corner)
    across = low + ACROSS * (high - low) - inner.tilt * corner
    middle = 0.5 * (low + high)
    level = sight.level(edge, across, inner.tilt, corner + WELL[0], corner + WELL[1])
    along = np.arange(across_lines[-1].at(middle) + BEYOND, across_lines[0].at(middle) + _WITHIN, PITCH)
    grey = sight.along(edge, across, inner.tilt, along)
    return EdgeStrip(level, _begins(along, grey, level), _left(along, grey, level), middle)


def read_slant(
    sight: Surfaces,
    edge: str,
    inner: EdgeLine,
    outer: EdgeLine,
    corner: float,
    across_lines: list[EdgeLine],
    level: float,
) -> float:
    """How askew a strip's end is, seen from inside: how much further in along it that is per way inwards across it.

    It is 0 where the strip is cut off straight, about 1 in a mitre, and NaN where it has no end.

    Args:
        sight: The picture.
        edge: "hinge" or "bottom".
        inner: The line inside of it.
        outer: The line outside of it.
        corner: Where the edge meets the other one [m].
        across_lines: Lines of the other edge, from the inside outwards.
        level: Brightness of the strip [grey levels].
    """
    low, high = outer.at(corner), inner.at(corner)
    middle = 0.5 * (low + high)
    # A mitre goes on as far along the strip as the strip is wide.
    stop = across_lines[0].at(middle) + _WITHIN + high - low
    along = np.arange(across_lines[-1].at(middle) + BEYOND, stop, PITCH)
    ends = []
    for shares in _TWO_SIDES:
        across = low + shares * (high - low) - inner.tilt * corner
        ends.append(_left(along, sight.along(edge, across, inner.tilt, along), level))
    if not np.isfinite(ends).all():
        return np.nan
    apart = (np.mean(_TWO_SIDES[1]) - np.mean(_TWO_SIDES[0])) * (high - low)
    return float((ends[1] - ends[0]) / apart)


def read_width(sight: Surfaces, edge: str, inner: EdgeLine, outer: EdgeLine, corner: float) -> float:
    """How wide a strip is [m], closer than its lines were found: between the steepest places of what lies across it.

    Args:
        sight: The picture.
        edge: "hinge" or "bottom".
        inner: The line inside of it.
        outer: The line outside of it.
        corner: Where the edge meets the other one [m].
    """
    along = np.arange(corner + _READ[0], corner + _READ[1], 4 * PITCH)
    middle = float(along.mean())
    # Lines that are not quite parallel may come near to each other there.
    reach = max(min(_NEAR, 0.45 * abs(inner.at(middle) - outer.at(middle))), _SMOOTH * _FINE)
    places = []
    for line in (inner, outer):
        near = line.at(middle) + np.arange(-reach, reach, _FINE)
        # Along one tilt, so that an error of it moves both alike.
        grey = sight.rows(edge, near - inner.tilt * middle, inner.tilt, along)
        steep = np.abs(np.convolve(np.diff(grey.mean(axis=1)), np.ones(_SMOOTH) / _SMOOTH, "same"))
        most = int(np.clip(np.argmax(steep), 1, steep.size - 2))
        before, here, after = steep[most - 1 : most + 2]
        bend = before - 2.0 * here + after
        part = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
        places.append(float(near[most] + _FINE * (0.5 + part)))
    return abs(places[0] - places[1])


def _begins(along: FloatArray, grey: FloatArray, level: float) -> float | None:
    """Where a strip of that level begins, from beyond it; grey levels (n,) at `along` (n,) [m]."""
    beyond = median(grey[:20])
    off = np.abs(grey - beyond)
    begun = np.flatnonzero(off > max(LEAST, _RISE * abs(level - beyond)))
    if abs(level - beyond) < LEAST:
        return -np.inf if begun.size < 0.1 * off.size else None
    if not begun.size:
        return np.inf
    first = int(begun[0])
    plateau = median(grey[first + 5 : first + 12]) if first + 12 < grey.size else median(grey[-8:])
    over = np.flatnonzero(off[first:] > 0.5 * abs(plateau - beyond))
    last = first + (int(over[0]) if over.size else 0)
    return float(along[last] - 0.5 * PITCH)


def _left(along: FloatArray, grey: FloatArray, level: float) -> float:
    """Where a strip of that level is left, from inside it; grey levels (n,) at `along` (n,) [m]."""
    plateau = median(grey[-20:])
    off = np.abs(grey - plateau)
    if abs(plateau - level) > max(LEAST, _RISE * level):
        return np.inf
    out = np.flatnonzero(off > max(LEAST, _RISE * level))
    if not out.size:
        return -np.inf
    last = int(out[-1])
    beyond = median(grey[max(last - 12, 0) : max(last - 3, 1)])
    over = np.flatnonzero(off > 0.5 * abs(plateau - beyond))
    return float(along[over[-1]] + 0.5 * PITCH)
