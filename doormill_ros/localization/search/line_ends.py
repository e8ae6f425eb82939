"""Where the lines that were found end: an edge ends at its corner."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import ByteArray, Float32Array, FloatArray
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.search.band import WING, Steps
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.search.shade import is_shadow
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView
from doormill_ros.statistics import median, row_medians

_PAST = (4.0e-3, 0.9e-3)  # where a line must have ended, beyond where it meets the other [m]
_RUNS_ON = 0.2  # a line runs on with that share of its step, lighter or darker: other things lie there
_RUNS_ON_ALONE = 0.03  # or with that share, where it is so many times as large as all other steps there
_ALONE = 2.5
FAINTEST = 1.5  # and with so many grey levels
_BESIDE = 10.0e-3  # how far beside a line it is compared with others where it runs on [m]
PLAIN = 4.0  # a step stands out when it is that many times as large as is usual beside it
_DRAWN_PAST = 15.0e-3  # what is drawn of a line beyond the corner [m]


def parallels(
    steps: Steps, line: EdgeLine, start: float, stop: float, reach: float
) -> tuple[FloatArray, Float32Array]:
    """Parallels of a line up to `reach` beside it [m]: offsets (m,) [m], steps between two places along (n, m)."""
    where = steps.where
    rows, at = steps.under_line(line.across, line.tilt, start, stop)
    number = int(reach / where.step)
    offsets = np.arange(-number, number + 1)
    columns = at[:, None] + offsets
    np.minimum(np.maximum(columns, 0, out=columns), len(where.across) - 1, out=columns)
    found: Float32Array = steps.rows[rows[:, None], columns]
    return np.multiply(offsets, where.step, dtype=float), found


def _stands_out(size: Float32Array, least: float) -> bool:
    """Whether the steps (m,) of parallels peak in their middle, by at least so much and above what is usual there."""
    middle = size.size // 2
    about = size[middle - 2 * WING : middle + 2 * WING + 1]
    usual = median(np.delete(size, slice(middle - 2 * WING, middle + 2 * WING + 1)))
    # What peaks beside the line is another one, which may well run on.
    here = abs(int(np.argmax(about)) - 2 * WING) < WING
    return bool(here and about.max() > max(least, FAINTEST, PLAIN * usual))


def _goes_on(steps: Steps, line: EdgeLine, end: float) -> bool:
    """Whether a line shows beyond a place along it [m]."""
    _, found = parallels(steps, line, end - _PAST[0], end - _PAST[1], _BESIDE)
    if len(found) < 2:
        return False
    size = np.abs(row_medians(found.T))
    share = _RUNS_ON_ALONE if _is_alone(size, found) else _RUNS_ON
    return _stands_out(size, share * abs(line.step))


def _is_alone(size: Float32Array, found: Float32Array) -> bool:
    """Whether one of the parallels about the middle has a step all along, and nothing beside it one nearly as large.

    Args:
        size: Median size of the steps of each, shape (m,) [grey levels].
        found: Their steps, shape (n, m) [grey levels].
    """
    middle = size.size // 2
    about = slice(middle - 2 * WING, middle + 2 * WING + 1)
    most = about.start + int(np.argmax(size[about]))
    steady = bool((found[:, most] > 0.0).all() or (found[:, most] < 0.0).all())
    return steady and bool(size[most] > _ALONE * np.delete(size, about).max())


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
        corner: Where the chosen ones meet, y and z, shape (2,) [m].

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
        f"the line taken for the {runs_on} edge runs on past the corner, which no edge of a door does: a jaw, a rail "
        "or a sill lies before the door, or the border of something behind it runs on just there; clear the view of "
        "the corner",
        edge=runs_on,
        marks=((runs_on, view.pixels(chosen[runs_on].points(runs_on, start))),),
    )
