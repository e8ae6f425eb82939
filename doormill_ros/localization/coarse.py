"""Finds the door's corner to about a pixel: which of the lines in the picture are the two edges.

The face is the innermost surface, so the innermost step that stands out of the face's own
texture is its edge; a rebate's lip, the back of a door or a rail behind it lie further out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray, IntArray
from doormill_ros.localization.band import ACROSS, WING, Band, Steps, band, find_steps, reduced
from doormill_ros.localization.errors import NoEdge, WrongEdge
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
_PARALLEL = 9.0e-3  # largest difference between the tilts of the two edges, as far as the search sees [rad]


@dataclass(frozen=True)
class EdgeLine:
    """A candidate: place at the nominal corner [m], slope across per along, step [grey levels]."""

    across: float
    tilt: float
    step: float


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
    share = float(np.sqrt(np.mean(np.minimum(texture, 3 * median(texture)) ** 2)))
    level = np.maximum(share * brightness, _FLOOR)
    best = strength.max(axis=0)
    best[np.abs(across) > reach] = 0.0
    # A step is as wide as the averages on its two sides; nearer maxima are the same edge.
    padded = np.zeros(best.size + 2 * WING, dtype=best.dtype)
    padded[WING:-WING] = best
    shifted = [padded[i : i + best.size] for i in range(2 * WING + 1)]
    peak = (best > np.max(shifted[:WING], axis=0)) & (best >= np.max(shifted[WING + 1 :], axis=0))
    peak &= best > np.maximum(_FAINTEST, _SIGNIFICANT * level)
    peak &= (best > _CERTAIN * level) | (best > 0.5 * best[peak].max(initial=0.0))
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
    for _ in range(3):
        weight = 1.0 / np.maximum(np.abs(d - at - slope * s), 0.3 * where.step) ** 1.5
        total = weight.sum()
        mean_s, mean_d = weight @ s / total, weight @ d / total
        slope = weight @ ((s - mean_s) * (d - mean_d)) / (weight @ (s - mean_s) ** 2)
        at = mean_d - slope * mean_s
    return EdgeLine(float(at), float(slope), line.step)


def meet(hinge: EdgeLine, bottom: EdgeLine) -> FloatArray:
    """Pose (y, z, rotation) of the corner of two lines; the rotation is the mean of theirs."""
    # Hinge: y = a + p z, bottom: z = b + q y; a turn by r tilts them by -r and +r.
    y = (hinge.across + hinge.tilt * bottom.across) / (1 - hinge.tilt * bottom.tilt)
    return np.array([y, bottom.across + bottom.tilt * y, np.arctan((bottom.tilt - hinge.tilt) / 2)])


def _ends_at_corner(steps: dict[str, Steps], hinge: EdgeLine, bottom: EdgeLine, corner: FloatArray) -> bool:
    """Whether both edges are there near the corner and at least one of them ends in it."""
    beyond, close = [], []
    for edge, line, at in ((HINGE, hinge, corner[1]), (BOTTOM, bottom, corner[0])):
        # Chips may have taken more than half of the wood near the corner, or a clamp may hide it.
        sign = np.sign(line.step)
        quantile = 0.6 if sign > 0 else 0.4
        near, far = (
            sign * steps[edge].along_line(line.across, line.tilt, at + 0.8e-3, at + reach, quantile)
            for reach in _NEAR_CORNER
        )
        if max(near, far) < 0.35 * abs(line.step):
            return False
        close.append(near > 0.35 * abs(line.step))
        outside = steps[edge].along_line(line.across, line.tilt, at - 3.0e-3, at - 0.9e-3)
        beyond.append(sign * outside > 0.5 * max(near, far))
    # What hides one edge near the corner hides where a line too far in would give itself away: then the other must end.
    if not all(close):
        return any(close) and not beyond[close.index(True)]
    return not all(beyond)


def search_bands(view: FaceView, limit: float, rotation: float) -> dict[str, Band]:
    """The strips in which `search` looks for the edges; they depend on the door's size only and are kept."""
    out = {}
    for edge in (HINGE, BOTTOM):
        reach = limit + rotation * view.length(edge) + _MARGIN
        out[edge] = band(view, edge, reach, reach + _INSIDE)
    return out


def search(picture: ByteArray, view: FaceView, limit: float, rotation: float) -> FloatArray:
    """Rough pose of the corner of the door's face: y, z [m] and rotation [rad], shape (3,).

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        limit: Largest offset looked for [m].
        rotation: Largest rotation looked for [rad].

    Raises:
        NoEdge: Nothing stands out of the texture where an edge must be.
        WrongEdge: Lines stand out, but no two of them make the corner of a face.
    """
    small = reduced(picture)
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
                "of the door must be; check that a door stands in the fixture and how it is lit",
                edge=edge,
            )
        lines[edge] = [refine(steps[edge], line) for line in lines[edge]]
    # A line that no other meets at a right angle is a shadow or a tool. Of what remains the innermost
    # two are the face's, or nothing is: to fall back on lines further out would be to guess.
    square = np.array([[abs(h.tilt + b.tilt) < _PARALLEL for b in lines[BOTTOM]] for h in lines[HINGE]])
    inside = [[np.abs(meet(h, b)[:2]).max() < limit + _STRAY for b in lines[BOTTOM]] for h in lines[HINGE]]
    if np.any(np.logical_and(square, inside)):
        square = np.logical_and(square, inside)
    if np.any(square):
        hinge = lines[HINGE][int(np.argmax(np.any(square, axis=1)))]
        bottom = lines[BOTTOM][int(np.argmax(np.any(square, axis=0)))]
        corner = meet(hinge, bottom)
        if abs(hinge.tilt + bottom.tilt) < _PARALLEL and _ends_at_corner(steps, hinge, bottom, corner):
            return corner
    raise WrongEdge(
        f"{len(lines[HINGE])} upright and {len(lines[BOTTOM])} level lines were found, but the innermost of them "
        "do not meet at a right angle and end where they meet; clear the view of the door's corner"
    )
