"""A second corner within the one that was found: the door's own, where another one stands behind it.

Doors of one make are nearly alike, and the hindmost has the largest step. What shows of it round the face of the first
is a strip along both edges, and a wedge where it is turned: its borders are too faint, or too askew, for the search.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import ByteArray, Float32Array, FloatArray
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.search.grain import goes_on
from doormill_ros.localization.search.neighbourhood import Neighbourhood
from doormill_ros.localization.search.shade import Surfaces
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView
from doormill_ros.statistics import NORMAL_STD, median, row_medians, running_means
from doormill_ros.units import m_to_mm, rad_to_deg

_PIECE = 8  # rows averaged along an edge
_WING, _EVERY = 4, 2  # px averaged on each side of a step, and between the places that are tried
_TURN, _FURTHEST = 4.0e-3, 40.0e-3  # turns tried against the edge, and the largest [rad]
_LEAST = 0.4  # share of the pieces in which a line must be inside of the edge
_FLOOR = 0.003  # texture that noise alone makes, as a share of the face's brightness
_SIGNIFICANT = 3.0  # both lines stand out of the texture by so many standard deviations,
_ALIKE = 4.0  # and their steps differ by less than that factor;
_FAINTEST = 0.02  # fainter ones are no surface's border, as a share of the face's brightness
_SURELY, _AS_LARGE = 5.0, 2.5  # the same two for lines that may be on the face,
_AS_WIDE = 0.3e-3  # unless as far from both edges as a lipping's are, as far as is seen here [m]
_TOGETHER = (
    8.5  # askew lines stand out of the texture by so many, as geometric mean of both: grain has up to 7.5
)
_ASKEW = 3.0e-3  # turned by more than that against an edge a line is no lipping's border [rad]
_SQUARE = 6.0e-3  # the two make a corner when their turns differ by less [rad]


@dataclass(frozen=True, eq=False)
class _Scan:
    """Steps of lines inside of one edge.

    Attributes:
        pieces: Steps inside minus outside in each piece of the edge, as shares of its brightness, shape (m, p).
        first: Where the first of the m is, inwards of the edge [px].
        along: Where the pieces are, from the corner [px], shape (p,).
        scores: Median over the pieces by turn and by place in the middle of the pieces, shape (k, m).
        level: Standard deviation of the scores that texture makes.
    """

    pieces: Float32Array
    first: int
    along: FloatArray
    scores: Float32Array
    level: float

    def line(self, turn: int, place: int) -> tuple[float, float, float]:
        """Place at the corner [px], turn [rad] and step of a line, closer than it was tried."""
        middle = float(self.along.mean())
        expected = place + _turns()[turn] * (self.along - middle) / _EVERY
        sign = np.sign(self.scores[turn, place])
        near = np.rint(expected).astype(int) + np.arange(-3, 4)[:, None]
        inside = (near >= 0) & (near < len(self.pieces))
        steps = sign * self.pieces[np.clip(near, 0, len(self.pieces) - 1), np.arange(self.along.size)]
        steps[~inside] = -1.0
        most = steps.argmax(axis=0)
        column = np.arange(self.along.size)
        good = (steps[most, column] > 0.4 * abs(self.scores[turn, place])) & (most > 0) & (most < 6)
        if good.sum() < 5:
            return self.first + _EVERY * float(place), float(_turns()[turn]), float(self.scores[turn, place])
        before, here, after = (steps[np.clip(most + by, 0, 6), column] for by in (-1, 0, 1))
        part = 0.5 * (before - after) / np.minimum(before - 2.0 * here + after, -1e-9)
        at = self.first + _EVERY * (near[most, column] + np.where(good, np.clip(part, -0.5, 0.5), 0.0))
        for _ in range(3):
            slope, start = np.polyfit(self.along[good], at[good], 1)
            off = np.abs(at - start - slope * self.along)
            good = good & (off <= max(2.5 * NORMAL_STD * median(off[good]), 1.0))
        return float(start), float(slope), float(sign * median(steps[most, column][good]))


def _turns() -> FloatArray:
    """The turns that are tried, shape (k,) [rad]."""
    number = round(_FURTHEST / _TURN)
    return np.asarray(np.arange(-number, number + 1) * _TURN, dtype=float)


def _scan(beside: Neighbourhood, corner: float) -> _Scan:
    """Steps inside of an edge that ends in such a row (column for the bottom edge)."""
    count = beside.face.shape[1] // _PIECE
    used = slice(0, count * _PIECE)
    face = beside.face[::-1, used].reshape(-1, count, _PIECE).sum(axis=2)
    face = face / np.maximum(face.mean(axis=0), 1.0)
    along = np.abs(beside.rows[used].reshape(count, _PIECE).mean(axis=1) - corner)
    means = running_means(face.T, _WING)
    steps = means[:, _WING:] - means[:, :-_WING]
    steps -= row_medians(steps)[:, None]  # light that changes across the edge
    pieces = np.ascontiguousarray(steps.T[::_EVERY])
    shift = np.rint(np.multiply.outer(_turns(), along - along.mean()) / _EVERY).astype(int)
    rim = int(np.abs(shift).max())
    padded = np.full((len(pieces) + 2 * rim, count), np.nan, dtype=np.float32)
    padded[rim : rim + len(pieces)] = pieces
    tried = padded[np.arange(len(pieces))[:, None] + rim + shift[:, None, :], np.arange(count)]
    tried.sort(axis=-1)  # what lies outside of the edge comes last
    inside = count - np.isnan(tried).sum(axis=-1)
    scores = np.take_along_axis(tried, inside[..., None] // 2, axis=-1)[..., 0]
    scores[inside < _LEAST * count] = 0.0
    level = max(NORMAL_STD * median(np.abs(scores[inside >= _LEAST * count])), _FLOOR)
    return _Scan(pieces, beside.gap + _WING, along, scores, level)


def corner_within(
    picture: ByteArray,
    view: FaceView,
    pose: FloatArray,
    around: Mapping[str, Neighbourhood],
    edges: Mapping[str, EdgeLine],
) -> dict[str, EdgeLine]:
    """The lines of a second corner within the one found, parallel to the edges; empty where none is to be judged.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        pose: Of the corner: y, z [m] and rotation [rad], shape (3,).
        around: What lies beside each edge.
        edges: The edges, as they were when that was learned.

    Raises:
        WrongEdge: It is turned against the edges, which no lipping is, and the texture of the face ends there.
    """
    at = view.pixels(pose[None, :2])[0]
    scans = {}
    # Grain hardly ever runs along the bottom edge, which alone tells of most doors that there is none.
    for edge, row in ((BOTTOM, at[0]), (HINGE, at[1])):
        scans[edge] = _scan(around[edge], float(row))
        if scans[edge].scores.max() < _SIGNIFICANT * scans[edge].level > -scans[edge].scores.min():
            return {}
    found = _pair(scans[HINGE], scans[BOTTOM])
    if found is None:
        return {}
    lines, apart = {}, 0.0
    for edge, (place, turn, step), start in zip((HINGE, BOTTOM), found, (pose[1], pose[0]), strict=True):
        own = edges[edge]
        across = own.across + place * view.pixel - turn * float(start)
        lines[edge] = EdgeLine(across, own.tilt + turn, step * median(around[edge].face[-1]))
        apart = max(apart, place * view.pixel)
    (_, first, step), (_, second, its) = found
    turned = 0.5 * abs(second - first)
    sizes = abs(step) / scans[HINGE].level, abs(its) / scans[BOTTOM].level
    if turned > _ASKEW:
        if np.sqrt(sizes[0] * sizes[1]) < _TOGETHER:
            return {}
        sight = Surfaces(picture, view)
        corner = {HINGE: float(pose[1]), BOTTOM: float(pose[0])}
        if any(goes_on(sight, edge, [line, edges[edge]], 0, corner[edge]) for edge, line in lines.items()):
            return {}
        raise WrongEdge(
            f"within the corner that was found another one shows, {m_to_mm(apart):.1f} mm further in and turned by "
            f"{rad_to_deg(turned):.2f} degrees against it: that of the door, and what was found is another one behind "
            "it, or something lies askew on the face; clear what stands behind the door",
            marks=tuple(
                (edge, view.pixels(line.points(edge, float(start))))
                for (edge, line), start in zip(lines.items(), (pose[1], pose[0]), strict=True)
            ),
        )
    sure = min(sizes) > _SURELY and 1.0 / _AS_LARGE < step / its < _AS_LARGE
    return lines if sure and abs(found[0][0] - found[1][0]) * view.pixel > _AS_WIDE else {}


def _pair(hinge: _Scan, bottom: _Scan) -> tuple[tuple[float, float, float], ...] | None:
    """The most significant pair of lines, one along each edge, that make a corner; place [px], turn [rad] and step."""
    best, most = None, _SIGNIFICANT
    count = len(hinge.scores)
    for sign in (1.0, -1.0):
        for turn in range(count):
            one = sign * hinge.scores[turn] / hinge.level
            # Turned by as much, the other edge's tilt is the opposite.
            turns = np.arange(max(count - 2 - turn, 0), min(count - turn + 1, count))
            other = sign * bottom.scores[turns] / bottom.level
            size = min(float(one.max()), float(other.max()))
            if size > most:
                row, place = np.unravel_index(int(np.argmax(other)), other.shape)
                best, most = (turn, int(np.argmax(one)), int(turns[row]), int(place)), size
    if best is None:
        return None
    lines = hinge.line(*best[:2]), bottom.line(*best[2:])
    (_, first, step), (_, second, its) = lines
    if (
        min(abs(step), abs(its)) < _FAINTEST
        or abs(first + second) > _SQUARE
        or not 1.0 / _ALIKE < step / its < _ALIKE
    ):
        return None
    return lines
