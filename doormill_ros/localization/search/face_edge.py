"""Which of the lines along an edge is the edge of the face: of strips round it, those that lie on it are told.

What frames the face along both edges is a lipping on it, or a bevel, a lip or another door behind: told by what happens
where the strips cross, and by how wide they are.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.localization.search.edge_layers import TOGETHER, EdgeLayers
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.search.shade import PITCH
from doormill_ros.localization.search.strips import ACROSS, LEAST, EdgeStrip, read_width
from doormill_ros.localization.view import HINGE

_TWIN = 0.7  # strips along both edges that are one differ by less than that factor in width
_CROSSED = 0.07  # strips fainter than that in the logarithm tell nothing where they cross
_FACE = 0.02  # and those fainter than that are no strips
_BRIGHT = 225.0  # strips brighter than that may be clipped where they cross [grey levels]
_SHRINKS = 0.12e-3  # difference between two widths that tells; equal ones differ by less than half of it [m]
_SLANT = (0.4, 2.5)  # how far a bevel or lip sticks out, over how far it lies behind


def settle(one: EdgeLayers, other: EdgeLayers) -> EdgeLine:
    """The edge of the face.

    Args:
        one: The lines along it, judged.
        other: Those along the other edge, judged.

    Raises:
        WrongEdge: A strip beside it may belong to the face or not.
    """
    k = one.first
    rest = one.strips[k:]
    if rest and _may_be_face(one, k):
        while k < len(one.strips) and _may_be_face(one, k):
            crossed = _crossed(one, other)
            if crossed is None and not other.strips[other.first :]:
                if not one.flush(k, other):
                    raise one.doubt(k, k + 1)
                crossed = True
            behind = False if crossed else _lies_behind(one, k, other, other.first)
            if behind is None and not one.drawn(k, other, other.first):
                raise one.doubt(k, k + 1)
            if behind:
                break
            k += 1
    elif k and _framed(one, other):
        raise one.doubt(0, k)
    elif rest and (_turns_round(one, k, other) or _ends_with_face(one, k, other)):
        raise one.doubt(k, k + 1)
    return one.lines[k]


def _may_be_face(one: EdgeLayers, k: int) -> bool:
    """Whether strip k is no background, and does not end elsewhere than the face does."""
    return not one.like_background(one.strips[k]) and one.ends[k] is not False


def _lies_behind(one: EdgeLayers, k: int, other: EdgeLayers, j: int) -> bool | None:
    """Whether strip k and strip j of the other edge lie behind the face; None where their widths do not tell.

    What lies behind shrinks towards the optical axis, from which the two edges are not equally far. A bevel or a
    lip sticks out by some of what it lies behind, and what both widths together say of that must be so; a lipping
    is as wide along both.
    """
    if j >= len(other.strips):
        return None
    mine, its = (
        read_width(e.sight, e.edge, e.lines[i], e.lines[i + 1], e.corner) for e, i in ((one, k), (other, j))
    )
    view = one.sight.view
    outside = -view.distance * view.sight(one.corner_of(k, other))
    own, across = outside if one.edge == HINGE else outside[::-1]
    shrinks = float((its - mine) / (own - across))
    if abs(its - mine) > _SHRINKS and 0.0 < shrinks < 1.0:
        behind = view.distance * shrinks / (1.0 - shrinks)
        sticks_out = (mine + own * shrinks) / (1.0 - shrinks)
        return True if _SLANT[0] < sticks_out / behind < _SLANT[1] else None
    least = mine / _SLANT[1]
    would_tell = abs(own - across) * least > _SHRINKS * (view.distance + least)
    return False if would_tell and abs(its - mine) < 0.5 * _SHRINKS else None


def check_agrees(hinge: EdgeLayers, bottom: EdgeLayers, found: dict[str, EdgeLine]) -> None:
    """Whether a strip that was taken for a part of the face has no twin along the other edge that was not.

    Args:
        hinge: That edge.
        bottom: The other one.
        found: What was taken for the edges of the face.

    Raises:
        WrongEdge: It has: one plane or bevel runs round the corner.
    """
    for one, two in ((hinge, bottom), (bottom, hinge)):
        k, j = one.lines.index(found[one.edge]), two.lines.index(found[two.edge])
        if k and j < len(two.strips):
            mine, its = one.against_face(one.strips[k - 1].level), two.against_face(two.strips[j].level)
            wide = two.width(j) / one.width(k - 1)
            if abs(mine - its) < _CROSSED and _TWIN < wide < 1.0 / _TWIN:
                raise one.doubt(k - 1, k)


def _turns_round(one: EdgeLayers, k: int, other: EdgeLayers) -> bool:
    """Whether strip k, hardly brighter or darker than the background, goes round the corner as a band would.

    It ends beyond the other edge by its own width: there its twin ends, which is too faint to be seen.
    """
    strip = one.strips[k]
    if strip.end is None or not np.isfinite(strip.end) or not one.like_background(strip):
        return False
    beyond = other.lines[other.first].at(strip.middle) - strip.end
    return _seen(one, strip) and abs(beyond - one.width(k)) < TOGETHER


def _ends_with_face(one: EdgeLayers, k: int, other: EdgeLayers) -> bool:
    """Whether strip k, hardly brighter or darker than the background, ends just where a band on the face would."""
    return bool(one.ends[k]) and _seen(one, one.strips[k]) and one.flush(k, other)


def _seen(one: EdgeLayers, strip: EdgeStrip) -> bool:
    """Whether a strip differs from the background by so much that its border can be placed."""
    return abs(strip.level - one.back) > LEAST


def _framed(one: EdgeLayers, other: EdgeLayers) -> bool:
    """Whether strips as bright as the face run round its corner uncrossed: another door behind, or a frame.

    A frame that is as wide along both edges is a lipping.
    """
    if not other.first:
        return False
    k, j = one.first - 1, other.first - 1
    mine, its = one.against_face(one.strips[k].level), other.against_face(other.strips[j].level)
    one_thing, uncrossed = abs(mine - its) < _CROSSED, _crossed(one, other) is False
    if not (one_thing or uncrossed):
        return False
    behind = _lies_behind(one, k, other, j)
    # Strips too faint to tell where they cross, not so faint as to be face, are believed unless they differ in width.
    faint = _FACE < min(abs(mine), abs(its)) < _CROSSED and max(abs(mine), abs(its)) < 2 * _CROSSED
    uneven = faint and abs(one.width(k) - other.width(j)) > 2 * _SHRINKS
    if behind:
        return one_thing
    return (uncrossed or uneven) and behind is None and not one.drawn(k, other, j)


def _crossed(one: EdgeLayers, other: EdgeLayers) -> bool | None:
    """Whether the outermost strips of both edges cross, as strips on one plane do; None if that cannot be told."""
    if not one.strips or not other.strips:
        return None
    mine, its = one.strips[-1], other.strips[-1]
    first, second = (e.against_face(s.level) for s, e in ((mine, one), (its, other)))
    if min(abs(first), abs(second)) < _CROSSED or first * second < 0 or max(mine.level, its.level) > _BRIGHT:
        return None
    low, high = one.lines[-1].at(one.corner), one.lines[-2].at(one.corner)
    across = low + ACROSS * (high - low) - one.lines[-1].tilt * one.corner
    begin, stop = other.lines[-1].at(low), other.lines[-2].at(low)
    width = stop - begin
    square = one.sight.level(
        one.edge, across, one.lines[-1].tilt, begin + 0.3 * width, stop - 0.3 * width + PITCH
    )
    found = one.against_face(square)
    return bool(abs(found - first - second) < abs(found - 0.5 * (first + second)))
