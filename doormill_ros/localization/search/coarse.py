"""Finds the door's corner to about a pixel: which of the lines in the picture are the two edges.

The face is the innermost surface, so the innermost step that stands out of the face's own
texture is its edge; a rebate's lip, the back of a door or a rail behind it lie further out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache, reduce
from math import sqrt

import numpy as np

from doormill_ros.arrays import BoolArray, ByteArray, Float32Array, FloatArray, IntArray
from doormill_ros.localization.errors import NoEdge, WrongEdge
from doormill_ros.localization.lines.fit import line_products, weighted_line
from doormill_ros.localization.search.band import ACROSS, WING, Band, Steps, band, find_steps
from doormill_ros.localization.search.edge_line import EdgeLine, meet
from doormill_ros.localization.search.layers import choose
from doormill_ros.localization.search.line_ends import check_ends
from doormill_ros.localization.search.stand_ins import check_stand_ins
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView
from doormill_ros.statistics import median

_MARGIN = 2.0e-3  # how far beyond the largest displacement of an edge the search reaches [m]
_INSIDE = 30.0e-3  # how much of the face beside an edge serves to learn its texture [m]
_SIGNIFICANT = 4.0  # an edge stands out of the texture by that many standard deviations,
_CERTAIN = 7.0  # and by that many if a line further out is more than twice as strong
_FLOOR = 0.25  # texture that noise alone makes [grey levels]
_FAINTEST = 3.5  # smallest step taken for an edge [grey levels]
_STRAY = 0.5e-3  # lines that far out of range are passed over if others are in range [m]
_NEAR_CORNER = (16.0e-3, 32.0e-3)  # an edge must show within the second, one of the two within the first [m]
# Beside a broken corner, or else beyond a heap of dust, an edge must show that share of its step [m].
_BROKEN, _BURIED, _WHOLE = (_NEAR_CORNER[1], 60.0e-3), (60.0e-3, 120.0e-3), 0.7
_SIDE_BY_SIDE = 12.0e-3  # largest difference between the tilts of lines that run side by side [rad]
_PARALLEL = 9.0e-3  # largest difference between the tilts of the two edges, as far as the search sees [rad]


def candidates(steps: Steps, reach: float) -> tuple[list[EdgeLine], float]:
    """Lines that stand out of the texture, from the inside outwards, and the texture's level.

    Args:
        steps: Steps of one edge's band.
        reach: Largest distance of an edge's middle from its nominal place [m].
    """
    strength = np.abs(steps.scores)
    near = strength.shape[1]
    across, brightness = steps.where.across[:near], steps.brightness[:near]
    # The contrast of texture goes with the light, so it is learned in relation to the brightness.
    far = steps.brightness[near + WING : steps.brightness.size - WING]
    texture = np.abs(steps.texture) / np.maximum(far, 5.0)
    texture = np.minimum(texture, 3 * median(texture)).ravel()
    share = sqrt(float(texture @ texture) / texture.size)
    level = np.maximum(share * brightness, _FLOOR)
    best = strength.max(axis=0)
    best[np.abs(across) > reach] = 0.0
    # A step is as wide as the averages on its two sides; nearer maxima are the same edge.
    padded = np.zeros(best.size + 2 * WING, dtype=best.dtype)
    padded[WING:-WING] = best
    shifted = [padded[i : i + best.size] for i in range(2 * WING + 1)]
    peak = best > reduce(np.maximum, shifted[:WING])
    peak &= best >= reduce(np.maximum, shifted[WING + 1 :])
    peak &= best > np.maximum(_FAINTEST, _SIGNIFICANT * level)
    strongest = best[peak].max(initial=0.0)
    # Outside of the strongest even a faint one may be the edge: that of a strip, or of a face in shadow.
    outside = across < across[int(np.argmax(np.where(peak, best, 0.0)))]
    peak &= (best > _CERTAIN * level) | (best > 0.5 * strongest) | (outside & (best > 0.1 * strongest))
    found = np.flatnonzero(peak)
    lines = []
    for j in found[::-1]:
        k = int(np.argmax(strength[:, j]))
        tilt = float(steps.tilts[k])
        lines.append(EdgeLine(float(across[j]) - tilt * steps.middle, tilt, float(steps.scores[k, j])))
    return lines, median(level)


@lru_cache(maxsize=256)
def _distant_pairs(count: int) -> tuple[IntArray, IntArray]:
    """Numbers i < j of the pairs of `count` pieces that are at least a quarter of them apart."""
    return np.triu_indices(count, max(count // 4, 1))


def refine(steps: Steps, line: EdgeLine) -> EdgeLine:
    """Place a line to about a pixel: peak of the step in each piece of edge, then a robust line."""
    where, half = steps.where, 3
    centre = np.rint((line.across + line.tilt * steps.centres - where.across[0]) / where.step).astype(int)
    centre = np.minimum(np.maximum(centre, half), len(where.across) - half - 1)
    span = np.arange(-half, half + 1)
    windows = np.sign(line.step) * steps.segments[np.arange(len(centre))[:, None], centre[:, None] + span]
    highest = windows.argmax(axis=1)
    top = np.minimum(np.maximum(highest, 1), 2 * half - 1)
    i = np.arange(len(centre))
    left, middle, right = windows[i, top - 1], windows[i, top], windows[i, top + 1]
    bend = 2 * middle - left - right
    place = top - half + 0.5 * (right - left) / np.maximum(bend, 1e-6)
    good = (middle > 0.3 * abs(line.step)) & (bend > 1e-6) & (highest == top)  # not rising out of the window
    if good.sum() < 4:
        return line
    s = steps.centres[good]
    # Steps sit between samples: step j compares the samples before j with those from j on.
    d = where.across[0] + where.step * (centre[good] + np.minimum(np.maximum(place[good], -half), half) - 0.5)
    # Median of the slopes between distant pieces: a clamp or chips on a quarter of them do no harm.
    first, second = _distant_pairs(s.size)
    slope = median((d[second] - d[first]) / (s[second] - s[first]))
    at = median(d - slope * s)
    products = line_products(s, d)
    for _ in range(3):
        weight = 1.0 / np.maximum(np.abs(d - at - slope * s), 0.3 * where.step) ** 1.5
        middle, place, slope = weighted_line(products, weight)
        at = place - slope * middle
    return EdgeLine(at, slope, line.step)


def _ends_at_corner(
    steps: dict[str, Steps], hinge: EdgeLine, bottom: EdgeLine, corner: FloatArray, broken: bool
) -> bool:
    """Whether both edges are there near the corner, or beyond what is `broken` off it, and at least one ends in it."""
    beyond, close = [], []
    for edge, line, at in ((HINGE, hinge, corner[1]), (BOTTOM, bottom, corner[0])):
        # Chips may have taken more than half of the wood near the corner, or a clamp may hide it.
        sign = np.sign(line.step)
        quantile = 0.6 if sign > 0 else 0.4
        near, far = (
            sign * steps[edge].along_line(line.across, line.tilt, at + 0.8e-3, at + reach, quantile)
            for reach in _NEAR_CORNER
        )
        if max(near, far) < 0.35 * abs(line.step):  # a corner may be broken off, or buried by dust
            far = max(
                sign * steps[edge].along_line(line.across, line.tilt, at + first, at + last)
                for first, last in (_BROKEN, _BURIED)
            )
            if not broken or far < _WHOLE * abs(line.step):
                return False
        close.append(near > 0.35 * abs(line.step))
        outside = steps[edge].along_line(line.across, line.tilt, at - 3.0e-3, at - 0.9e-3)
        beyond.append(sign * outside > 0.5 * max(near, far))
    # What hides one edge near the corner hides where a line too far in would give itself away: then the other must end.
    if not any(close):
        return not any(beyond)
    if not all(close):
        return not beyond[close.index(True)]
    return not all(beyond)


@dataclass(frozen=True, eq=False)
class Sighted:
    """A corner that the search has found.

    Attributes:
        pose: y, z [m] and rotation [rad], shape (3,).
        lines: Along each edge, from the inside outwards, the edge's own among them.
    """

    pose: FloatArray
    lines: dict[str, list[EdgeLine]]


def _parallels(lines: list[EdgeLine], chosen: BoolArray) -> list[EdgeLine]:
    """Of the chosen lines (n,) those that run along the innermost of them, from the inside outwards."""
    left = [line for line, one in zip(lines, chosen, strict=True) if one]
    return [line for line in left if abs(line.tilt - left[0].tilt) < _SIDE_BY_SIDE]


def search_bands(view: FaceView, limit: float, rotation: float) -> dict[str, Band]:
    """The strips in which `search` looks for the edges; they depend on the door's size only and are kept."""
    out = {}
    for edge in (HINGE, BOTTOM):
        reach = limit + rotation * view.length(edge) + _MARGIN
        out[edge] = band(view, edge, reach, reach + _INSIDE)
    return out


def search(
    picture: ByteArray,
    small: dict[str, Float32Array],
    view: FaceView,
    limit: float,
    rotation: float,
    broken: bool = True,
) -> Sighted:
    """Roughly the corner of the door's face.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        small: The picture as `reduced` gives it.
        view: The camera before the face.
        limit: Largest offset looked for [m].
        rotation: Largest rotation looked for [rad].
        broken: Whether a corner that is broken off is one.

    Raises:
        NoEdge: Nothing stands out of the texture where an edge must be.
        WrongEdge: Lines stand out, but no two of them make the corner of a face.
    """
    bands = search_bands(view, limit, rotation)
    pitch = 1.5 * ACROSS * view.pixel / max(b.along[-1] for b in bands.values())
    number = int(np.ceil(rotation / pitch)) + 1
    tilts = np.arange(-number, number + 1) * pitch
    steps, lines = {}, {}
    for edge in (HINGE, BOTTOM):
        where = bands[edge]
        widest = limit + 0.5 * rotation * (limit + where.along[-1]) + 0.5 * _MARGIN
        steps[edge] = find_steps(small[edge], where, tilts, limit + 0.5e-3, widest)
        lines[edge], level = candidates(steps[edge], widest)
        if not lines[edge]:
            raise NoEdge(
                f"no line of at least {max(_FAINTEST, _SIGNIFICANT * level):.1f} grey levels where the {edge} edge "
                "of the door must be; check that a door stands in the fixture right side up, what covers its edge "
                "and how it is lit",
                edge=edge,
                marks=(
                    (edge, view.pixels(view.line(edge, np.zeros(3), np.linspace(0.0, view.length(edge), 9)))),
                ),
            )
        lines[edge] = [refine(steps[edge], line) for line in lines[edge]]
    # A line that no other meets at a right angle is a shadow or a tool.
    square = np.array([[abs(h.tilt + b.tilt) < _PARALLEL for b in lines[BOTTOM]] for h in lines[HINGE]])
    inside = [[np.abs(meet(h, b)[:2]).max() < limit + _STRAY for b in lines[BOTTOM]] for h in lines[HINGE]]
    if np.any(np.logical_and(square, inside)):
        square = np.logical_and(square, inside)
    if np.any(square):
        first = (
            lines[HINGE][int(np.argmax(np.any(square, axis=1)))],
            lines[BOTTOM][int(np.argmax(np.any(square, axis=0)))],
        )
        beside = {
            HINGE: _parallels(lines[HINGE], np.any(square, axis=1)),
            BOTTOM: _parallels(lines[BOTTOM], np.any(square, axis=0)),
        }
        layers = choose(picture, view, beside, meet(*first))
        found = layers.lines
        hinge, bottom = found[HINGE], found[BOTTOM]
        corner = meet(hinge, bottom)
        check_ends(picture, steps, view, found, beside, corner)
        check_stand_ins(steps, view, found, corner)
        layers.check()
        if abs(hinge.tilt + bottom.tilt) < _PARALLEL and _ends_at_corner(
            steps, hinge, bottom, corner, broken
        ):
            return Sighted(corner, beside)
    raise WrongEdge(
        f"{len(lines[HINGE])} upright and {len(lines[BOTTOM])} level lines were found, but the innermost of them "
        "do not meet at a right angle and end where they meet; clear the view of the door's corner",
        marks=tuple((edge, view.pixels(lines[edge][0].points(edge, 0.0))) for edge in (HINGE, BOTTOM)),
    )
