"""What stands in for an edge that begins only at some distance from the corner: either of the two may be the edge."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import BoolArray, ByteArray, FloatArray
from doormill_ros.localization.edge_points.profiles import Profiles, crossed_at, gather
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.lines.fit import LineFit
from doormill_ros.localization.search.band import WING, Steps
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.search.line_ends import FAINTEST, PLAIN, parallels
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView
from doormill_ros.statistics import median, row_medians
from doormill_ros.units import m_to_mm

_BEGINS = (0.8e-3, 62.0e-3)  # a line is looked for in these distances from the corner [m]
_STANDS = 16.0e-3  # how far beside it others are looked for where it is not there [m]
_THERE = 0.5  # it is there with that share of its step
_LEAST_GAP = 5  # samples lack it where another is looked for: the border of a smaller chip looks as straight
_STANDS_IN = 0.3  # which has that share of its step, and less than half of that where the line is
_FEW, _STEADY = 0.1, 0.7  # all but that share of its samples have that share of its step

# Nearer to a line than the parallels above are apart, rows tell.
# Beside a line they are looked at within so many pixels, where no more is missing than what lies behind would hide [m].
_NEAR, _NEAR_END, _NOTCH = 24, 90, 8.0e-3
# Corners are worn more often than anything stands in so near them: a shorter stretch lies further aside than what is
# worn, and one shorter still tells nothing.
_SHORT, _SHORTEST, _FAR_ASIDE = 3.0e-3, 1.2e-3, 3.5  # [m], [m], [px]
_RETURNS = 8, 6  # a line is there where of so many rows so many agree with it
_LEAVES = 3  # rows at the end of a stretch that may see both
# What is broken off has a ragged border that leads back to the line; another edge is straight and runs beside it.
_ASIDE = 1.1  # px that a stretch lies beside the line at least
_ASKEW = 0.3  # px that four fifths of its rows lie from a parallel at most
_STEPS = 0.85  # share of its distance that it still has where it ends


def check_stand_ins(
    steps: dict[str, Steps], view: FaceView, chosen: dict[str, EdgeLine], corner: FloatArray
) -> None:
    """Whether a line that begins only at some distance from the corner has no parallel in its place up to there.

    Tape over an edge, and what else covers it, lets the edge itself be seen beside its end only.

    Args:
        steps: Of each edge's band.
        view: The camera before the face.
        chosen: The lines taken for the edges.
        corner: Where they meet, y and z, shape (2,) [m].

    Raises:
        WrongEdge: There is one, so that either may be the edge.
    """
    for edge, at in ((HINGE, corner[1]), (BOTTOM, corner[0])):
        line = chosen[edge]
        offsets, found = parallels(steps[edge], line, at + _BEGINS[0], at + _BEGINS[1], _STANDS)
        middle = offsets.size // 2
        there = (np.sign(line.step) * found[:, middle - 1 : middle + 2]).max(axis=1)
        missing = there < _THERE * abs(line.step)
        gap = int(np.argmin(missing)) if not missing.all() else missing.size
        if gap < _LEAST_GAP or gap + _LEAST_GAP > missing.size:
            continue
        # The last sample of the gap may see both. The border of what is broken off runs askew: few samples share it.
        before, after = (np.abs(row_medians(part.T)) for part in (found[: gap - 1], found[gap + 1 :]))
        steady = np.quantile(np.abs(found[: gap - 1]), _FEW, axis=0) > _STEADY * before
        alone = (before > np.maximum(_STANDS_IN * abs(line.step), FAINTEST)) & (after < 0.5 * before) & steady
        alone[np.abs(np.arange(offsets.size) - middle) <= WING] = False
        usual = median(before)
        if alone.any() and before[alone].max() > PLAIN * usual:
            place = int(np.argmax(np.where(alone, before, 0.0)))
            begins = steps[edge].where.pitch * gap + _BEGINS[0]
            raise _either(edge, view, line, float(offsets[place]), begins, at)


def check_stretch(
    picture: ByteArray, view: FaceView, pose: FloatArray, profiles: Profiles, line: LineFit
) -> None:
    """Whether no stretch beside the line, nearer to it than other lines can be told, runs from the corner to it.

    The edge of a second door, say, that shows below the first one's and ends before its corner.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        pose: Of the line: y, z [m] and rotation [rad], shape (3,).
        profiles: Rows read along it, the corner's last.
        line: The line through their points.

    Raises:
        WrongEdge: There is one, so that either may be the edge.
    """
    missing = _missing(line.inliers)
    if missing * view.pixel < _SHORTEST:
        return
    rows = slice(len(profiles.lines) - missing, None)
    reach = _NEAR_END if missing * view.pixel < _NOTCH else _NEAR
    places = _places(picture, view, pose, profiles, rows, reach)[_LEAVES:]
    middle = median(places)
    off = np.abs(places - middle)
    aside = _FAR_ASIDE if missing * view.pixel < _SHORT else _ASIDE
    if abs(middle) < aside or np.quantile(off, 1.0 - 2.0 * _FEW) > _ASKEW:
        return
    near = np.flatnonzero(off < 3.0 * _ASKEW)
    start = np.polyfit(near, places[near], 1)[1]
    if start / middle > _STEPS:
        edge = profiles.edge
        raise _either(
            edge,
            view,
            EdgeLine.at_pose(edge, pose, profiles.step),
            -middle * view.pixel,
            missing * view.pixel,
            float(pose[1 if edge == HINGE else 0]),
        )


def _missing(there: BoolArray) -> int:
    """How many of the rows (n,) next to the corner do not agree with the line."""
    window, least = _RETURNS
    agreeing = np.convolve(there[::-1], np.ones(window, dtype=int), "valid") >= least
    return int(np.argmax(agreeing)) if agreeing.any() else len(there)


def _places(
    picture: ByteArray, view: FaceView, pose: FloatArray, profiles: Profiles, rows: slice, reach: int
) -> FloatArray:
    """Where within reach the largest step of the edge's sign is in some rows, outwards of the line [px], shape (n,)."""
    lines, centre = profiles.lines[rows], profiles.centre[rows]
    values = gather(picture, profiles.edge, lines, centre, np.arange(-reach, reach + 1))
    falls = values[:-3] + values[1:-2] - values[2:-1] - values[3:]  # from the face to what is behind it
    if profiles.step < 0.0:
        np.negative(falls, out=falls)
    most = np.argmax(falls, axis=0)
    row = np.arange(most.size)
    before, here, after = (falls[np.clip(most + by, 0, len(falls) - 1), row] for by in (-1, 0, 1))
    bends = before - 2.0 * here + after
    part = np.divide(0.5 * (before - after), bends, out=np.zeros(most.size), where=bends < 0.0)
    at = most + np.clip(part, -0.5, 0.5) + 1.5 - reach
    return np.asarray(at + centre - crossed_at(view, profiles.edge, pose, lines), dtype=float)


def _either(
    edge: str, view: FaceView, line: EdgeLine, apart: float, begins: float, corner: float
) -> WrongEdge:
    """The refusal of a line beside which another one runs, inwards by `apart` [m], until it begins."""
    other = EdgeLine(line.across + apart, line.tilt, line.step)
    return WrongEdge(
        f"the line taken for the {edge} edge begins {m_to_mm(begins):.0f} mm from the corner, and up to there "
        f"another runs {m_to_mm(abs(apart)):.1f} mm beside it: either may be the edge, the other what covers "
        "it, as tape does, or lies behind it; clear the edge",
        edge=edge,
        marks=tuple(
            (name, view.pixels(one.points(edge, corner))) for name, one in (("line", line), ("other", other))
        ),
    )
