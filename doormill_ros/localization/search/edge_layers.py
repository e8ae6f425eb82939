"""The steps along one edge: which strips between them belong to the face by brightness, end and what crosses them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.search.grain import goes_on
from doormill_ros.localization.search.shade import BESIDE, PITCH, WELL, Surfaces
from doormill_ros.localization.search.strips import ACROSS, LEAST, EdgeStrip, read_slant, read_strip
from doormill_ros.localization.view import HINGE
from doormill_ros.statistics import median
from doormill_ros.units import m_to_mm

_ALIKE = 0.19  # surfaces whose brightness differs by less in its logarithm may be of one plane and one light
# A strip further from the background than the face by that share of their difference lies before it
_BEYOND = 0.03
# A strip nearer to the background than that share of the face's difference from it is background; not one that differs
# from it by so much that anybody sees it [grey levels].
_BACKGROUND, _PLAINLY = 0.2, 12.0
TOGETHER = 0.25e-3  #: a strip that ends so near to the other edge ends with it [m]
_UNCLEAR = 1.0e-3  # between two places where a strip seems to end [m]
#: Where a strip's end is looked for that is to be placed exactly, beyond and within the other edge [m].
CLOSE = (-1.2e-3, 1.5e-3)
_MITRED = (
    0.5e-3,
    0.3,
)  # a strip cut off aslant is left so far from where it begins [m], and by that share of its width
_ASLANT = 0.4, 2.5  # how far it goes on along the strip over how far across it
_JUST_THERE = 0.08e-3  # a strip on the face ends within that of where the search has the other edge [m]
_TOLD, _AS_FLUSH = 0.06e-3, 0.33  # a bevel's end is seen from so far out [m], and a strip's nearer is flush


class EdgeLayers:
    """The lines of one edge, the strips between them, and what is known of each.

    Attributes:
        sight: The picture.
        edge: "hinge" or "bottom".
        lines: From the inside outwards.
        corner: Where they meet the other edge [m].
        strips: Between neighbouring lines.
        face, deep: Brightness of the face beside the innermost line and further inside [grey levels].
        back: Brightness outside of the outermost line [grey levels].
        first: Number of the innermost line that may be the face's edge.
        ends: Of each strip, whether it ends at the other edge; None where that cannot be told.
    """

    def __init__(
        self, sight: Surfaces, edge: str, lines: list[EdgeLine], corner: float, across_lines: list[EdgeLine]
    ) -> None:
        """Read the strips; the arguments as of the attributes, and the lines of the other edge."""
        self.sight, self.edge, self.lines, self.corner = sight, edge, lines, corner
        self.strips = [read_strip(sight, edge, a, b, corner, across_lines) for a, b in pairwise(lines)]
        beside = np.linspace(*BESIDE, 4)
        start, stop = corner + WELL[0], corner + WELL[1]
        deep = np.linspace(5.0e-3, 25.0e-3, 6)
        across = [lines[0].across + beside, lines[-1].across - beside, lines[0].across + deep]
        tilts = [lines[0].tilt, lines[-1].tilt, lines[0].tilt]
        self.face, self.back, self.deep = sight.levels(edge, across, tilts, start, stop)
        self.first = 0
        self.ends: list[bool | None] = []

    def against_face(self, level: float) -> float:
        """Logarithm of a level over the face's, which a groove beside the innermost line hides: of two, the nearer."""
        ratios = np.log(max(level, 1.0) / np.maximum([self.face, self.deep], 1.0))
        return float(ratios[np.argmin(np.abs(ratios))])

    def like_face(self, k: int) -> bool:
        """Whether strip k is as bright as the face, or further than it from what lies outside of both."""
        strip = self.strips[k]
        near = abs(self.against_face(strip.level)) < _ALIKE
        # Beside a gap behind the door may lie a rail as bright as the face.
        back = max(
            [self.back, *(one.level for one in self.strips[k + 1 :])], key=lambda it: abs(it - self.face)
        )
        apart = (strip.level - back) / (self.face - back) if self.face != back else 0.0
        return bool(apart > 1 + _BEYOND or (near and apart > 0.5))

    def like_background(self, strip: EdgeStrip) -> bool:
        """Whether a strip is as dark or bright as the background."""
        most = min(_BACKGROUND * abs(self.face - self.back), _PLAINLY)
        return abs(strip.level - self.back) < max(most, 0.5 * LEAST)

    def judge(self, other: EdgeLayers) -> None:
        """Where the strips end, and which of them belong to the face by their brightness and their end."""
        for strip in self.strips:
            if strip.end is None:
                self.ends.append(None)
                continue
            near = [abs(strip.end - line.at(strip.middle)) for line in other.lines]
            self.ends.append(min(near) < TOGETHER or self._left_with_face(len(self.ends), other))
        for k in range(len(self.strips)):
            if self.ends[k] is False and self._once_more(k):
                raise self.doubt(0, k + 1)
            if self.like_face(k) and self.ends[k] is not False:
                if not self.ends[k] and any(self.like_background(before) for before in self.strips[:k]):
                    raise self.doubt(0, k + 1)
                # A bevel that catches the light is as bright as the face, or brighter; it ends beside it.
                if (
                    k == 0
                    and not other.strips
                    and self._bevelled(k, other) > _TOLD
                    and not self.flush(k, other)
                ):
                    raise self.doubt(k, k + 1)
                self.first = k + 1

    def _left_with_face(self, k: int, other: EdgeLayers) -> bool:
        """Whether strip k, seen from inside, ends just where the face beside it does, whatever begins beyond.

        Stripes and rails behind hide where it ends only from beyond. What lies behind the face has no border just
        there: it would seem nearer to the optical axis.
        """
        strip, edge = self.strips[k], other.lines[other.first]
        near = abs(strip.left - edge.at(strip.middle)) < TOGETHER
        return near and self.flush(k, other, _JUST_THERE)

    def _once_more(self, k: int) -> bool:
        """Whether outside of a groove the face seems to lie once more, and what covers its end leaves that open."""
        strip = self.strips[k]
        if not k or strip.end is None or np.isneginf(strip.end):
            return False
        return self.like_face(k) and not abs(strip.end - strip.left) < _UNCLEAR

    def flush(self, k: int, other: EdgeLayers, most: float = np.inf) -> bool:
        """Whether strip k ends at the other edge where the face beside it does, closer than a bevel's end would.

        Both end within `most` of that edge [m]. A bevel lies on average half its width behind the face, and what lies
        behind seems nearer to the optical axis.
        """
        inner, wide = self.lines[k], self.width(k)
        high = inner.at(self.corner)
        places = high + wide * np.stack([ACROSS - 1.0, ACROSS])
        across = other.lines[other.first]
        start, stop = across.at(high) + CLOSE[0], across.at(high) + CLOSE[1]
        along = np.arange(start, stop, 0.5 * PITCH)
        ends = []
        for place in places:
            grey = self.sight.along(self.edge, place - inner.tilt * self.corner, inner.tilt, along)
            beyond, within = median(grey[:8]), median(grey[-8:])
            if abs(within - beyond) < LEAST:
                return False
            rise = (grey - beyond) / (within - beyond)
            first = int(np.argmax(rise > 0.5))
            if not first:
                return False
            before, after = float(rise[first - 1]), float(rise[first])
            at = float(along[first - 1]) + (0.5 - before) / (after - before) * 0.5 * PITCH
            ends.append(at - across.at(float(place.mean())))
        bevelled = self._bevelled(k, other)
        apart = abs(ends[0] - ends[1])
        return bevelled > _TOLD and apart < min(_AS_FLUSH * bevelled, most) and max(np.abs(ends)) < most

    def mitred(self, k: int, other: EdgeLayers) -> bool:
        """Whether strip k, which ends at the other edge, is cut off aslant there: bevels meet in a mitre."""
        strip = self.strips[k]
        if not self.ends[k] or strip.end is None:
            return False
        places = (strip.end, *(line.at(strip.middle) for line in other.lines))
        apart = min(abs(strip.left - place) for place in places)
        if apart < max(_MITRED[0], _MITRED[1] * self.width(k)):
            return False
        inner, outer = self.lines[k], self.lines[k + 1]
        slant = read_slant(self.sight, self.edge, inner, outer, self.corner, other.lines, strip.level)
        return _ASLANT[0] < slant < _ASLANT[1]

    def drawn(self, k: int, other: EdgeLayers, j: int) -> bool:
        """Whether the texture of the face tells that strip k lies on it: in it, or in strip j of the other edge.

        Where it goes on in that, no corner of a face is where their inner lines cross. Line k then ends with line j, or
        strip k with the face.
        """
        if goes_on(self.sight, self.edge, self.lines, k, self.corner):
            return True
        if j >= len(other.strips) or not goes_on(other.sight, other.edge, other.lines, j, other.corner):
            return False
        return self._turns(k, other, j) or self.flush(k, other)

    def _turns(self, k: int, other: EdgeLayers, j: int) -> bool:
        """Whether line k has ended where it crosses strip j of the other edge."""
        high = self.lines[k].at(self.corner)
        start, stop = (other.lines[j + 1].at(high), other.lines[j].at(high))
        inset = (1.0 - ACROSS[-1]) * (stop - start)
        wide = min(self.width(k), 2.0 * BESIDE[1])
        sides = [self.lines[k].across + sign * wide * ACROSS for sign in (1.0, -1.0)]
        tilts = [self.lines[k].tilt] * 2
        inside, outside = self.sight.levels(self.edge, sides, tilts, start + inset, stop - inset + PITCH)
        left = abs(np.log(max(inside, 1.0) / max(outside, 1.0)))
        return bool(left < 0.5 * abs(self.against_face(self.strips[k].level)))

    def _bevelled(self, k: int, other: EdgeLayers) -> float:
        """How far from the face's own end strip k would seem to end if it were a bevel of 45 degrees [m]."""
        run = 1 if self.edge == HINGE else 0
        return abs(float(self.sight.view.sight(self.corner_of(k, other))[run])) * 0.5 * self.width(k)

    def corner_of(self, k: int, other: EdgeLayers) -> FloatArray:
        """Where line k meets the other edge's face, y and z on the plane of the face, shape (2,) [m]."""
        high = self.lines[k].at(self.corner)
        end = other.lines[other.first].at(high)
        return np.array([high, end] if self.edge == HINGE else [end, high])

    def width(self, k: int) -> float:
        """Of a strip at the corner [m]."""
        return abs(self.lines[k].at(self.corner) - self.lines[k + 1].at(self.corner))

    def doubt(self, inner: int, outer: int) -> WrongEdge:
        """The refusal of two steps of which each may be the edge of the face."""
        first, second = self.lines[inner], self.lines[outer]
        apart = abs(first.at(self.corner) - second.at(self.corner))
        strip = self.strips[outer - 1]
        return WrongEdge(
            f"two steps {m_to_mm(apart):.1f} mm apart may be the {self.edge} edge: the inner one of "
            f"{abs(first.step):.0f} grey levels if the strip outside of it (grey {strip.level:.0f}, face "
            f"{self.face:.0f}) lies behind the face, the outer one of {abs(second.step):.0f} if it is a band or a "
            "shadow on the face; change the light or cover what stands behind",
            edge=self.edge,
            marks=tuple(
                (name, self.sight.view.pixels(line.points(self.edge, self.corner)))
                for name, line in (("inner", first), ("outer", second))
            ),
        )
