"""Steps that run side by side along an edge: which of them is the edge of the face, which a strip on it or behind it.

Grooves, lippings, edge bands and shadows lie on the face, whose edge is then the outermost step; a rebate's lip, a
bevel, a rail or another door lie behind it, and the face's edge is the innermost. Told apart by brightness, by where
a strip ends at the other edge - on the face it ends with the face - and by what happens where two strips cross.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization.edge_line import EdgeLine
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.shade import BESIDE, PITCH, WELL, Surfaces, shaded
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView
from doormill_ros.statistics import median
from doormill_ros.units import m_to_mm

_ALIKE = 0.19  # surfaces whose brightness differs by less in its logarithm may be of one plane and one light
# A strip further from the background than the face by that share of their difference lies before it
_BEYOND = 0.03
# A strip nearer to the background than that share of the face's difference from it is background
_BACKGROUND = 0.2
_LEAST = 5.0  # grey levels between two surfaces of which the border can be placed
_TOGETHER = 0.25e-3  # a strip that ends so near to the other edge ends with it [m]
_TWIN = 0.7  # strips along both edges that are one differ by less than that factor in width
_CROSSED = 0.07  # strips fainter than that in the logarithm tell nothing where they cross
_BRIGHT = 225.0  # strips brighter than that may be clipped where they cross [grey levels]
_ACROSS = np.linspace(0.3, 0.7, 5)  # where across a strip it is read, as shares of its width
# Where a strip's end is looked for, beyond the other edge's outermost and innermost line [m]
_END = (-6.0e-3, 4.0e-3)
_CLOSE = (-1.2e-3, 1.5e-3)  # the same for an end that is to be placed exactly [m]
_TOLD, _AS_FLUSH = 0.06e-3, 0.33  # a bevel's end is seen from so far out [m], and a strip's nearer is flush
_SEEN_STEP = 0.5  # share of the step along the whole edge that must be between both sides of a line where they are read
_AS_FACE = 0.2  # what differs from the face by less than that share of what its strips do is face
_STRAIGHT = 0.4e-3  # a strip that begins on all its parallels within that is cut off [m]
_APART = 1.5e-3  # lines so far from one another have steps of their own [m]
_RISE = 0.15  # a strip begins where it differs so much from what lies beyond, as a share of its difference


@dataclass(frozen=True)
class _Strip:
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


def _strip(
    sight: Surfaces, edge: str, inner: EdgeLine, outer: EdgeLine, corner: float, across_lines: list[EdgeLine]
) -> _Strip:
    low, high = outer.at(corner), inner.at(corner)
    across = low + _ACROSS * (high - low) - inner.tilt * corner
    middle = 0.5 * (low + high)
    level = sight.level(edge, across, inner.tilt, corner + WELL[0], corner + WELL[1])
    along = np.arange(across_lines[-1].at(middle) + _END[0], across_lines[0].at(middle) + _END[1], PITCH)
    grey = sight.along(edge, across, inner.tilt, along)
    return _Strip(level, _begins(along, grey, level), _left(along, grey, level), middle)


def _begins(along: FloatArray, grey: FloatArray, level: float) -> float | None:
    """Where a strip of that level begins, from beyond it; grey levels (n,) at `along` (n,) [m]."""
    beyond = median(grey[:20])
    off = np.abs(grey - beyond)
    begun = np.flatnonzero(off > max(_LEAST, _RISE * abs(level - beyond)))
    if abs(level - beyond) < _LEAST:
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
    if abs(plateau - level) > max(_LEAST, _RISE * level):
        return np.inf
    out = np.flatnonzero(off > max(_LEAST, _RISE * level))
    if not out.size:
        return -np.inf
    last = int(out[-1])
    beyond = median(grey[max(last - 12, 0) : max(last - 3, 1)])
    over = np.flatnonzero(off > 0.5 * abs(plateau - beyond))
    return float(along[over[-1]] + 0.5 * PITCH)


@dataclass(frozen=True, eq=False)
class Chosen:
    """The line of each edge that is the edge of the face, and what was read of the others."""

    lines: dict[str, EdgeLine]
    read: tuple[_Edge, ...] = ()

    def check(self) -> None:
        """Whether brightness and end of every strip tell where it lies; by now nothing else spoke against the lines.

        Raises:
            WrongEdge: One does not.
        """
        for edge, other in zip(self.read, self.read[::-1], strict=True):
            edge.check_told(other)


def choose(
    picture: ByteArray, view: FaceView, lines: dict[str, list[EdgeLine]], corner: FloatArray
) -> Chosen:
    """Tell the edges of the face from the lines beside them.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        lines: Parallels of each edge, from the inside outwards.
        corner: Where the innermost of them meet, y and z [m].

    Raises:
        WrongEdge: More than one of them may be it.
    """
    sight = Surfaces(picture, view)
    place = {HINGE: float(corner[1]), BOTTOM: float(corner[0])}
    if all(len(found) == 1 for found in lines.values()):
        return Chosen({edge: found[0] for edge, found in lines.items()})
    real = {}
    for edge, other in ((HINGE, BOTTOM), (BOTTOM, HINGE)):
        end = lines[other][-1].at(lines[edge][-1].at(place[edge]))
        shadows = [shaded(sight, edge, line, place[edge], end) for line in lines[edge]]
        real[edge] = [line for line, dark in zip(lines[edge], shadows, strict=True) if not dark]
        if not real[edge] or (any(shadows) and not _ends_face(sight, edge, real[edge][-1], place[edge], end)):
            raise WrongEdge(
                f"what runs along the {edge} edge goes on beyond the door: a shadow's border, and outside of it no "
                "step is to be seen; change the light",
                edge=edge,
            )
    read = {
        edge: _Edge(sight, edge, real[edge], place[edge], real[other])
        for edge, other in ((HINGE, BOTTOM), (BOTTOM, HINGE))
    }
    for edge, other in ((HINGE, BOTTOM), (BOTTOM, HINGE)):
        read[edge].judge(read[other])
    found = {edge: read[edge].settle(read[HINGE if edge == BOTTOM else BOTTOM]) for edge in read}
    read[HINGE].check_agrees(read[BOTTOM], found)
    return Chosen(found, (read[HINGE], read[BOTTOM]))


def _ends_face(sight: Surfaces, edge: str, line: EdgeLine, corner: float, end: float) -> bool:
    """Whether what lies outside of a line is rather what lies beyond the face, where that ends, than the face.

    A shadow's border so near to the edge of the face that the two look like one takes that away with it.
    """
    outer, inner = (line.across + sign * np.linspace(*BESIDE, 4) for sign in (-1.0, 1.0))
    tilts = [line.tilt, line.tilt]
    outside, face = sight.levels(edge, [outer, inner], tilts, corner + WELL[0], corner + WELL[1])
    beyond, _ = sight.levels(edge, [outer, inner], tilts, end - 8.0e-3, end - 1.5e-3)
    return abs(outside - face) > 0.5 * abs(beyond - face)


class _Edge:
    """The lines of one edge, the strips between them, and what is known of each."""

    def __init__(
        self, sight: Surfaces, edge: str, lines: list[EdgeLine], corner: float, across_lines: list[EdgeLine]
    ) -> None:
        self.sight, self.edge, self.lines, self.corner = sight, edge, lines, corner
        self.strips = [_strip(sight, edge, a, b, corner, across_lines) for a, b in pairwise(lines)]
        beside = np.linspace(*BESIDE, 4)
        start, stop = corner + WELL[0], corner + WELL[1]
        deep = np.linspace(5.0e-3, 25.0e-3, 6)
        across = [lines[0].across + beside, lines[-1].across - beside, lines[0].across + deep]
        tilts = [lines[0].tilt, lines[-1].tilt, lines[0].tilt]
        self.face, self.back, self.deep = sight.levels(edge, across, tilts, start, stop)
        self.first = 0  # the innermost line that may be the face's edge
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

    def like_background(self, strip: _Strip) -> bool:
        """Whether a strip is as dark or bright as the background."""
        return abs(strip.level - self.back) < max(_BACKGROUND * abs(self.face - self.back), 0.5 * _LEAST)

    def judge(self, other: _Edge) -> None:
        """Where the strips end, and which of them belong to the face by their brightness and their end."""
        for strip in self.strips:
            if strip.end is None:
                self.ends.append(None)
                continue
            near = [abs(strip.end - line.at(strip.middle)) for line in other.lines]
            self.ends.append(min(near) < _TOGETHER)
        for k in range(len(self.strips)):
            if self.like_face(k) and self.ends[k] is not False:
                if not self.ends[k] and any(self.like_background(before) for before in self.strips[:k]):
                    raise self.doubt(0, k + 1)
                # A bevel that catches the light is as bright as the face, or brighter; it ends beside it.
                if (
                    k == 0
                    and not other.strips
                    and self._bevelled(k, other) > _TOLD
                    and not self._flush(k, other)
                ):
                    raise self.doubt(k, k + 1)
                self.first = k + 1

    def check_told(self, other: _Edge) -> None:
        """As of `Chosen.check`.

        Tape across it is as bright on it as outside. A strip on the face does not reach the corner where that is
        broken off, and seems to go on beyond it where something like it lies behind.

        Raises:
            WrongEdge: One does not.
        """
        last = len(self.strips) - 1
        if self.strips:
            inside = [self.strips[last].level]
            if self._width(last) < _APART:
                inside.append(self.face)  # the step of a line holds that of another so near to it
            seen = max(abs(level - self.back) for level in inside)
            hidden = seen < _SEEN_STEP * abs(self.lines[-1].step)
            # Outside of a groove, which ends with the face, lies the face once more.
            strips = max(abs(strip.level - self.deep) for strip in self.strips)
            face_once_more = bool(self.ends[last]) and abs(self.back - self.deep) < _AS_FACE * strips
            if hidden or face_once_more:
                raise self.doubt(last, last + 1)
        for k, strip in enumerate(self.strips):
            # What is darker than a rail behind is a gap before that.
            apart = (strip.level - self.back) / (self.face - self.back) if self.face != self.back else 1.0
            if apart < _BACKGROUND or strip.end is None:
                continue
            short = strip.end > other.lines[0].at(strip.middle) + _TOGETHER
            with_face = any(abs(strip.left - line.at(strip.middle)) < _TOGETHER for line in other.lines)
            if (short and not self._cut_off(k, other)) or (with_face and not self.ends[k]):
                raise self.doubt(k, k + 1)

    def _cut_off(self, k: int, other: _Edge) -> bool:
        """Whether strip k begins along a straight line, and the face beside it at its corner: no wood is missing."""
        inner, wide = self.lines[k], self._width(k)
        high, first = inner.at(self.corner), other.lines[0]
        places = high + wide * np.concatenate([_ACROSS - 1.0, _ACROSS[-1:]])
        start, stop = first.at(high) - _CLOSE[1], first.at(high) + WELL[1]
        grey = self.sight.rows(
            self.edge, places - inner.tilt * self.corner, inner.tilt, np.arange(start, stop, PITCH)
        ).astype(float)
        beyond, within = np.median(grey[:, :8], axis=1), np.median(grey[:, -100:], axis=1)
        there = np.abs(grey - within[:, None]) < np.abs(grey - beyond[:, None])
        # What begins is there from then on.
        begins = PITCH * (there.shape[1] - np.argmin(there[:, ::-1], axis=1))
        strip, face = begins[:-1], float(begins[-1])
        return bool(np.ptp(strip) < _STRAIGHT and face < _CLOSE[1] + _STRAIGHT)

    def settle(self, other: _Edge) -> EdgeLine:
        """The edge of the face.

        Raises:
            WrongEdge: A strip beside it may belong to the face or not.
        """
        k = self.first
        rest = self.strips[k:]
        if rest and self._may_be_face(k):
            while k < len(self.strips) and self._may_be_face(k):
                crossed = self._crossed(other)
                if crossed is None and not other.strips[other.first :]:
                    if not self._flush(k, other):
                        raise self.doubt(k, k + 1)
                    crossed = True
                if not crossed:
                    break
                k += 1
        elif k and self._framed(other):
            raise self.doubt(0, k)
        elif rest and (self._turns_round(k, other) or self._ends_with_face(k, other)):
            raise self.doubt(k, k + 1)
        return self.lines[k]

    def _may_be_face(self, k: int) -> bool:
        """Whether strip k is no background, and does not end elsewhere than the face does."""
        return not self.like_background(self.strips[k]) and self.ends[k] is not False

    def _flush(self, k: int, other: _Edge) -> bool:
        """Whether strip k ends at the other edge where the face beside it does, closer than a bevel's end would.

        A bevel lies on average half its width behind the face, and what lies behind seems nearer to the optical axis.
        """
        inner, wide = self.lines[k], self._width(k)
        high = inner.at(self.corner)
        places = high + wide * np.stack([_ACROSS - 1.0, _ACROSS])
        across = other.lines[other.first]
        start, stop = across.at(high) + _CLOSE[0], across.at(high) + _CLOSE[1]
        along = np.arange(start, stop, 0.5 * PITCH)
        ends = []
        for place in places:
            grey = self.sight.along(self.edge, place - inner.tilt * self.corner, inner.tilt, along)
            beyond, within = median(grey[:8]), median(grey[-8:])
            if abs(within - beyond) < _LEAST:
                return False
            rise = (grey - beyond) / (within - beyond)
            first = int(np.argmax(rise > 0.5))
            if not first:
                return False
            before, after = float(rise[first - 1]), float(rise[first])
            at = float(along[first - 1]) + (0.5 - before) / (after - before) * 0.5 * PITCH
            ends.append(at - across.at(float(place.mean())))
        bevelled = self._bevelled(k, other)
        return bevelled > _TOLD and abs(ends[0] - ends[1]) < _AS_FLUSH * bevelled

    def _bevelled(self, k: int, other: _Edge) -> float:
        """How far from the face's own end strip k would seem to end if it were a bevel of 45 degrees [m]."""
        high = self.lines[k].at(self.corner)
        end = other.lines[other.first].at(high)
        run = 1 if self.edge == HINGE else 0
        point = np.array([high, end] if self.edge == HINGE else [end, high])
        return abs(float(self.sight.view.sight(point)[run])) * 0.5 * self._width(k)

    def check_agrees(self, other: _Edge, found: dict[str, EdgeLine]) -> None:
        """Whether a strip that was taken for a part of the face has no twin along the other edge that was not.

        Args:
            other: The other edge.
            found: What was taken for the edges of the face.

        Raises:
            WrongEdge: It has: one plane or bevel runs round the corner.
        """
        for one, two in ((self, other), (other, self)):
            k, j = one.lines.index(found[one.edge]), two.lines.index(found[two.edge])
            if k and j < len(two.strips):
                mine, its = one.against_face(one.strips[k - 1].level), two.against_face(two.strips[j].level)
                wide = two._width(j) / one._width(k - 1)
                if abs(mine - its) < _CROSSED and _TWIN < wide < 1.0 / _TWIN:
                    raise one.doubt(k - 1, k)

    def _turns_round(self, k: int, other: _Edge) -> bool:
        """Whether strip k, hardly brighter or darker than the background, goes round the corner as a band would.

        It ends beyond the other edge by its own width: there its twin ends, which is too faint to be seen.
        """
        strip = self.strips[k]
        if strip.end is None or not np.isfinite(strip.end) or not self.like_background(strip):
            return False
        beyond = other.lines[other.first].at(strip.middle) - strip.end
        return self._seen(strip) and abs(beyond - self._width(k)) < _TOGETHER

    def _ends_with_face(self, k: int, other: _Edge) -> bool:
        """Whether strip k, hardly brighter or darker than the background, ends just where a band on the face would."""
        return bool(self.ends[k]) and self._seen(self.strips[k]) and self._flush(k, other)

    def _seen(self, strip: _Strip) -> bool:
        """Whether a strip differs from the background by so much that its border can be placed."""
        return abs(strip.level - self.back) > _LEAST

    def _width(self, k: int) -> float:
        """Of a strip at the corner [m]."""
        return abs(self.lines[k].at(self.corner) - self.lines[k + 1].at(self.corner))

    def _framed(self, other: _Edge) -> bool:
        """Whether strips as bright as the face run round its corner uncrossed: a frame, or another door behind."""
        return bool(other.first and self._crossed(other) is False)

    def _crossed(self, other: _Edge) -> bool | None:
        """Whether the outermost strips of both edges cross, as strips on one plane do; None if that cannot be told."""
        if not self.strips or not other.strips:
            return None
        mine, its = self.strips[-1], other.strips[-1]
        one, two = (e.against_face(s.level) for s, e in ((mine, self), (its, other)))
        if min(abs(one), abs(two)) < _CROSSED or one * two < 0 or max(mine.level, its.level) > _BRIGHT:
            return None
        low, high = self.lines[-1].at(self.corner), self.lines[-2].at(self.corner)
        across = low + _ACROSS * (high - low) - self.lines[-1].tilt * self.corner
        begin, stop = other.lines[-1].at(low), other.lines[-2].at(low)
        width = stop - begin
        square = self.sight.level(
            self.edge, across, self.lines[-1].tilt, begin + 0.3 * width, stop - 0.3 * width + PITCH
        )
        found = self.against_face(square)
        return bool(abs(found - one - two) < abs(found - 0.5 * (one + two)))

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
