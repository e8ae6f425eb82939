"""What lies beside an edge: blur and textures, and the steps that run along it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.arrays import ByteArray, Float32Array, FloatArray, IntArray
from doormill_ros.localization.edge_points.blur import Spread, edge_spread, textured_blur
from doormill_ros.localization.edge_points.profiles import Profiles, crossed_at, gather
from doormill_ros.localization.edge_points.texture import (
    Variograms,
    learn_variograms,
    step_weights,
    steps_beside,
    streaks,
)
from doormill_ros.localization.lines.fit import LineFit
from doormill_ros.localization.view import FaceView
from doormill_ros.statistics import NORMAL_STD, median, row_medians

WIDE_HALF = 12  #: px on each side; wide enough to catch an edge four pixels from where the search has it
EVERY = 6  #: rows left out while focusing in
# Pixels looked at on each side of an edge, in standard deviations of its blur. Where nothing but noise is beside
# the edge, more of them tell its two levels better; where streaks are, they tell more of the streaks.
_REACH, _PLAIN_REACH = 2.5, 4.0
_WIDEST = 2 * WIDE_HALF  # px; largest lag of the widest window, which sees no more than one edge
_CLEAR = 3.0  # rows nearer to their line than that many standard deviations tell the blur
_LASTING = 8.0e-3  # rows that far apart have only streaks in common [m]
_TEXTURE = 0.25  # largest standard deviation of a texture, as a share of the step
_LOOK_INSIDE, _LOOK_OUTSIDE = 90, 40  # px; how far from an edge other steps are looked for
_FACE_STRIP, _BACK_STRIP = 40, 12  # px; surfaces beside an edge whose texture is learned


@dataclass(frozen=True, eq=False)
class Neighbourhood:
    """What lies beside one edge, and how its rows are to be read.

    Attributes:
        spread: Blur of the edge.
        weights: For its rows, as its blur and the textures beside it ask for, shape (PHASES, 3, w).
        face: Rows of the face beside it, a column each [grey levels], shape (m, n).
        gap: How far the last of the face's pixels are from it, inwards [px].
        rows: Their numbers, shape (n,).
        step: Step at the edge [grey levels].
        streaks: Standard deviation of what the rows have in common [grey levels].
        inside: Texture of the face.
        outside: Texture of what lies behind it.
        beside: Distances of other steps inwards of this one [px], the largest first, and their size [grey levels].
    """

    spread: Spread
    weights: Float32Array
    face: Float32Array
    gap: int
    rows: IntArray
    step: float
    streaks: float
    inside: Variograms
    outside: Variograms
    beside: list[tuple[int, float]]


def look_around(
    picture: ByteArray, view: FaceView, pose: FloatArray, wide: Profiles, line: LineFit
) -> Neighbourhood:
    """Learn blur and texture along an edge, and the steps beside it.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        pose: Where the edge runs: y, z [m] and rotation [rad], shape (3,).
        wide: Rows read about it.
        line: The line through their points.
    """
    edge = wide.edge
    shift = crossed_at(view, edge, pose, wide.lines) - wide.centre
    off = np.abs(line.residuals)
    spread = edge_spread(wide, shift, off < _CLEAR * NORMAL_STD * median(off[line.inliers]))
    gap = int(np.ceil(3.0 * spread.blur)) + 2
    span = np.arange(-gap - _LOOK_INSIDE, gap + _LOOK_OUTSIDE + 1)
    values = gather(picture, edge, wide.lines, wide.centre, span)
    beyond = values[-_LOOK_OUTSIDE:]
    face, back = values[:_LOOK_INSIDE], beyond[:_BACK_STRIP]
    strip = face[-_FACE_STRIP:]
    # Rows in light and in shadow are brought to one level, or their median would step where a shadow ends.
    some = face[:, ::3]
    level = np.maximum(some.sum(axis=0) / np.float32(len(some)), 1.0)
    common = row_medians(some * (level.mean() / level))
    beside = [(distance + gap, step) for distance, step in steps_beside(common, wide.step)]
    outwards = row_medians(beyond[::-1, ::3])
    beside += [(-distance - gap, -step) for distance, step in steps_beside(outwards, wide.step)[::-1]]
    apart, most = max(round(_LASTING / view.pixel / EVERY), 1), _TEXTURE * abs(wide.step)
    inside, outside = (learn_variograms(side, _WIDEST, apart, most) for side in (strip, back))
    spread = replace(spread, blur=textured_blur(spread, wide.step, inside, outside))
    reach = _PLAIN_REACH if inside.plain and outside.plain else _REACH
    half = min(max(int(np.ceil(reach * spread.blur + 2.0)), 4), WIDE_HALF)
    return Neighbourhood(
        spread,
        step_weights(half, spread.blur, inside, outside),
        face,
        gap + 1,
        wide.lines,
        wide.step,
        streaks(common[-_FACE_STRIP:]),
        inside,
        outside,
        beside,
    )
