"""Where the lines that were found end: an edge of a door ends at its corner, and near it no other step stands in for it."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import ByteArray, Float32Array, FloatArray
from doormill_ros.localization.band import WING, Steps
from doormill_ros.localization.edge_line import EdgeLine
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.layers import is_shadow
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView
from doormill_ros.statistics import median, row_medians
from doormill_ros.units import m_to_mm

_PAST = (4.0e-3, 0.9e-3)  # where a line must have ended, beyond where it meets the other [m]
_RUNS_ON = 0.03  # a line runs on with that share of its step, lighter or darker: other things lie there
_FAINTEST = 1.5  # and with so many grey levels
_BESIDE = 10.0e-3  # how far beside a line others are looked for [m]
_PLAIN = 4.0  # a step stands out when it is that many times as large as is usual beside it
_DRAWN_PAST = 15.0e-3  # what is drawn of a line beyond the corner [m]


def _parallels(steps: Steps, line: EdgeLine, start: float, stop: float) -> tuple[FloatArray, Float32Array]:
    """Steps on parallels of a line between two places along it: the offsets (m,) [m], and steps (n, m) [grey levels]."""
    where = steps.where
    first, last = np.searchsorted(where.along, [start, stop])
    chosen = np.arange(first, last)
    number = int(_BESIDE / where.step)
    offsets = np.arange(-number, number + 1)
    at = np.rint((line.at(where.along[chosen]) - where.across[0]) / where.step).astype(int)
    columns = np.clip(at[:, None] + offsets, 0, len(where.across) - 1)
    return offsets * where.step, steps.rows[chosen[:, None], columns]


def _stands_out(size: Float32Array, least: float) -> bool:
    """Whether the steps (m,) of parallels peak in their middle, by at least so much and above what is usual there."""
    middle = size.size // 2
    about = size[middle - 2 * WING : middle + 2 * WING + 1]
    usual = median(np.delete(size, slice(middle - 2 * WING, middle + 2 * WING + 1)))
    # What peaks beside the line is another one, which may well run on.
    here = abs(int(np.argmax(about)) - 2 * WING) < WING
    return bool(here and about.max() > max(least, _FAINTEST, _PLAIN * usual))


def _goes_on(steps: Steps, line: EdgeLine, end: float) -> bool:
    """Whether a line shows beyond a place along it [m]."""
    _, found = _parallels(steps, line, end - _PAST[0], end - _PAST[1])
    return len(found) > 1 and _stands_out(np.abs(row_medians(found.T)), _RUNS_ON * abs(line.step))


def check_ends(
    picture: ByteArray,
    steps: dict[str, Steps],
    view: FaceView,
    chosen: dict[str, EdgeLine],
    beside: dict[str, list[EdgeLine]],
    corner: FloatArray,
) -> None:
    """Whether both edges end where they meet, or at the latest where the strips beside the other edge do.

    A shadow's border does run on, and so do edges past the corner it seems to make: that is told from closer by.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        steps: Of each edge's band.
        view: The camera before the face.
        chosen: The lines taken for the edges.
        beside: All parallels of each, from the inside outwards.
        corner: Where the chosen ones meet, y and z [m].

    Raises:
        WrongEdge: One runs on: a jaw, a rail or a sill lies before the edge.
    """
    ends, runs_on = {}, None
    for edge, other, at in ((HINGE, BOTTOM, corner[1]), (BOTTOM, HINGE, corner[0])):
        line, last = chosen[edge], beside[other][-1]
        ends[edge] = min(at, last.at(line.at(at)))
        if runs_on is None and all(_goes_on(steps[edge], line, end) for end in (at, ends[edge])):
            runs_on = edge
    if runs_on is None or any(is_shadow(picture, view, e, chosen[e], corner, ends[e]) for e in ends):
        return
    start = corner[1 if runs_on == HINGE else 0] - _DRAWN_PAST
    raise WrongEdge(
        f"the line taken for the {runs_on} edge runs on past the corner, which no edge of a door does: a jaw, a rail or "
        "a sill lies before the door, or the border of something behind it runs on just there; clear the view of the "
        "corner",
        edge=runs_on,
        marks=((runs_on, view.pixels(chosen[runs_on].points(runs_on, start))),),
    )
