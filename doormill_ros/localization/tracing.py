"""From a rough pose to the two fitted edges: focus in, learn the surroundings, read every row."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.arrays import ByteArray, Float32Array, FloatArray, IntArray
from doormill_ros.localization import checks
from doormill_ros.localization.blur import Spread, edge_spread, textured_blur
from doormill_ros.localization.fit import LineFit, fit_line, pooled
from doormill_ros.localization.profiles import Profiles, crossing, gather, measure, plain_weights
from doormill_ros.localization.settings import LocalizerSettings
from doormill_ros.localization.texture import learn_variograms, push, step_inside, step_weights, streaks
from doormill_ros.localization.view import BOTTOM, EDGES, HINGE, FaceView
from doormill_ros.statistics import NORMAL_STD, column_medians, median, share

_WIDE_BLUR, _WIDE_HALF = 3.0, 12  # px; wide enough to catch an edge four pixels from where the search has it
_EVERY = 6  # rows left out while focusing in
# Wide, then sharp focusing ends when the edges move by less than the first two [px]; when they move
# by more than the third, blur and texture are learned again.
_CAUGHT, _NEAR, _FAR = 1.5, 0.6, 1.2
# Pixels looked at on each side of an edge, in standard deviations of its blur. Where nothing but noise is beside
# the edge, more of them tell its two levels better; where streaks are, they tell more of the streaks.
_REACH, _PLAIN_REACH = 2.5, 4.0
_WIDEST = (
    2 * _WIDE_HALF
)  # px; largest lag of the widest window, which sees no more than was found to be one edge
_CLEAR = 3.0  # rows nearer to their line than that many standard deviations tell the blur
_LASTING = 8.0e-3  # rows that far apart have only streaks in common [m]
_TEXTURE = 0.25  # largest standard deviation of a texture, as a share of the step
_LOOK_INSIDE, _FACE_STRIP, _BACK_STRIP = 90, 40, 12  # px; surfaces beside an edge whose texture is learned


@dataclass(frozen=True, eq=False)
class Trace:
    """One edge, read.

    Attributes:
        profiles: Its rows.
        spread: Its blur.
        line: The line through its points, on the plane of the face.
    """

    profiles: Profiles
    spread: Spread
    line: LineFit


def _line(view: FaceView, profiles: Profiles, pose: FloatArray, rounds: int) -> LineFit:
    """Line through an edge's points on the plane of the face."""
    y, z = view.points(profiles.pixels).T
    tilt = np.tan(pose[2])
    if profiles.edge == HINGE:
        return fit_line(z, y, profiles.edge_like, (pose[0] + tilt * pose[1], -tilt), rounds)
    return fit_line(y, z, profiles.edge_like, (pose[1] - tilt * pose[0], tilt), rounds)


def _poses(lines: dict[str, LineFit]) -> dict[str, FloatArray]:
    """Pose (y, z, rotation) as each line has it: one corner, but a rotation of its own.

    A right angle is not asked for yet, so that a wrong pair of lines shows as such in the end.
    """
    p, q = lines[HINGE].slope, lines[BOTTOM].slope
    a, b = lines[HINGE].place - p * lines[HINGE].middle, lines[BOTTOM].place - q * lines[BOTTOM].middle
    y = (a + p * b) / (1 - p * q)
    z = b + q * y
    return {HINGE: np.array([y, z, -np.arctan(p)]), BOTTOM: np.array([y, z, np.arctan(q)])}


def _moved(view: FaceView, before: dict[str, FloatArray], after: dict[str, FloatArray]) -> float:
    """Largest movement of the edges' ends between two poses [px]."""
    most = 0.0
    for edge in EDGES:
        ends = np.array([0.0, view.length(edge)])
        move = view.line(edge, after[edge], ends) - view.line(edge, before[edge], ends)
        most = max(most, float(np.abs(move).max()))
    return most / view.pixel


@dataclass(frozen=True, eq=False)
class _Lens:
    """How the rows of one edge are to be read.

    Attributes:
        spread: Blur of the edge.
        weights: For its rows, as its blur and the textures beside it ask for.
        face: Rows of the face beside it [grey levels].
        rows: Their numbers.
        streaks: Standard deviation of what the rows have in common [grey levels].
        inner: Distance of another edge inside of this one [px], or None.
    """

    spread: Spread
    weights: Float32Array
    face: Float32Array
    rows: IntArray
    streaks: float
    inner: float | None


def _lens(picture: ByteArray, view: FaceView, pose: FloatArray, wide: Profiles, line: LineFit) -> _Lens:
    """Learn blur and texture along an edge that runs where `pose` says, from rows read about it and their line."""
    edge = wide.edge
    lines, at = crossing(view, edge, pose, 0, -5.0e-3)
    shift = np.interp(wide.lines, lines, at) - wide.centre
    off = np.abs(line.residuals)
    spread = edge_spread(wide, shift, off < _CLEAR * NORMAL_STD * median(off[line.inliers]))
    gap = int(np.ceil(3.0 * spread.blur)) + 2
    span = np.arange(-gap - _LOOK_INSIDE, gap + _BACK_STRIP + 1)
    values = gather(picture, edge, wide.lines, wide.centre, span).astype(np.float32)
    face, back = values[:, :_LOOK_INSIDE], values[:, -_BACK_STRIP:]
    strip = face[:, -_FACE_STRIP:]
    # Rows in light and in shadow are brought to one level, or their median would step where a shadow ends.
    some = face[::3]
    level = np.maximum(some.mean(axis=1, keepdims=True), 1.0)
    common = column_medians(some * (level.mean() / level))
    inner = step_inside(common, wide.step)
    apart, most = max(round(_LASTING / view.pixel / _EVERY), 1), _TEXTURE * abs(wide.step)
    inside, outside = (learn_variograms(side, _WIDEST, apart, most) for side in (strip, back))
    spread = replace(spread, blur=textured_blur(spread, wide.step, inside, outside))
    reach = _PLAIN_REACH if inside.plain and outside.plain else _REACH
    half = min(max(int(np.ceil(reach * spread.blur + 2.0)), 4), _WIDE_HALF)
    return _Lens(
        spread,
        step_weights(half, spread.blur, inside, outside),
        face,
        wide.lines,
        streaks(common[-_FACE_STRIP:]),
        None if inner is None else inner + gap,
    )


def _focus(
    picture: ByteArray, view: FaceView, poses: dict[str, FloatArray], settings: LocalizerSettings
) -> tuple[dict[str, FloatArray], dict[str, Profiles], dict[str, LineFit]]:
    """Poses to about half a pixel, with windows wide enough for what the search leaves open; rows and lines."""
    weights = plain_weights(_WIDE_HALF, _WIDE_BLUR)
    for _ in range(3):
        wide, lines = {}, {}
        for edge in EDGES:
            wide[edge] = measure(picture, view, edge, poses[edge], weights, _EVERY)
            checks.check_rows(wide[edge], settings)
            lines[edge] = _line(view, wide[edge], poses[edge], 2)
        before, poses = poses, _poses(lines)
        if _moved(view, before, poses) < _CAUGHT:
            break
    return poses, wide, lines


def trace_edges(
    picture: ByteArray, view: FaceView, pose: FloatArray, settings: LocalizerSettings
) -> dict[str, Trace]:
    """Read both edges.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        pose: Rough y, z [m] and rotation [rad], shape (3,).
        settings: Limits of refusal.

    Raises:
        LocalizationError: NoEdge, WrongEdge, TooFewInliers, Blurred or OverExposed.
    """
    poses = dict.fromkeys(EDGES, pose)
    for _ in range(3):
        poses, wide, near = _focus(picture, view, poses, settings)
        lenses = {edge: _lens(picture, view, poses[edge], wide[edge], near[edge]) for edge in EDGES}
        if all(lens.inner is None for lens in lenses.values()):
            break
        move = [(lenses[edge].inner or 0.0) * view.pixel for edge in EDGES]
        poses = {edge: poses[edge] + [*move, 0.0] for edge in EDGES}
    else:
        raise checks.edge_in_edge()
    for _ in range(4):
        profiles, lines = {}, {}
        for edge, lens in lenses.items():
            profiles[edge] = measure(picture, view, edge, poses[edge], lens.weights)
            checks.check_rows(profiles[edge], settings)
            lines[edge] = _line(view, profiles[edge], poses[edge], 4)
        before, poses = poses, _poses(lines)
        moved = _moved(view, before, poses)
        if moved < _NEAR:
            break
        if moved > _FAR:
            poses, wide, near = _focus(picture, view, poses, settings)
            lenses = {edge: _lens(picture, view, poses[edge], wide[edge], near[edge]) for edge in EDGES}
    lines = pooled(lines)
    out = {}
    for edge, lens in lenses.items():
        step, line = profiles[edge].step, lines[edge]
        # A ragged edge smears the rows laid over each other as a soft one does.
        ragged = line.scatter / view.pixel
        blur = float(np.sqrt(max(lens.spread.blur**2 - ragged**2, 0.0)))
        checks.check_spread(edge, replace(lens.spread, blur=blur), lens.streaks / abs(step), settings)
        checks.check_share(edge, share(line.inliers), settings)
        pushed = push(lens.face, lens.rows, lens.weights, lens.spread.blur, step)
        line = line.pushed(pushed.place * view.pixel**2, pushed.slope)
        out[edge] = Trace(profiles[edge], lens.spread, line)
    return out
