"""From a rough pose to the two fitted edges: focus in, learn the surroundings, read every row."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import cos, isfinite, sin

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization import checks
from doormill_ros.localization.edge_points.blur import Spread
from doormill_ros.localization.edge_points.profiles import Profiles, measure, plain_weights
from doormill_ros.localization.edge_points.texture import push
from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.lines.fit import LineFit, crossing, fit_line, pooled
from doormill_ros.localization.rims.both_rims import EdgeRead, find_borders
from doormill_ros.localization.search.coarse import Sighted
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.search.layers import choose
from doormill_ros.localization.search.neighbourhood import EVERY, WIDE_HALF, Neighbourhood, look_around
from doormill_ros.localization.search.second_look import check_again
from doormill_ros.localization.search.stand_ins import check_stretch
from doormill_ros.localization.search.within import corner_within
from doormill_ros.localization.settings import LocalizerSettings
from doormill_ros.localization.view import BOTTOM, EDGES, HINGE, FaceView
from doormill_ros.statistics import share

_WIDE_BLUR = 3.0  # px
_NARROW_BLUR = 1.5  # px; where another step is near
# Wide, then sharp focusing ends when the edges move by less than the first two [px]; when they move
# by more than the third, blur and texture are learned again.
_CAUGHT, _NEAR, _FAR = 1.5, 0.6, 1.2
_SAME = 0.05  # px between two places of an edge at which surroundings and rows are the same
_KNOWN = 0.8e-3  # lines so near to one another are one [m]
_ASIDE = 0.6  # px between line and edge from which rows are read again beside another step


@dataclass(frozen=True, eq=False)
class Trace:
    """One edge, read.

    Attributes:
        profiles: Its rows.
        spread: Its blur.
        line: The line through its points, on the plane of the face.
        streaks: Standard deviation of the streaks beside it, as a share of the step.
        plain: Whether one step is all that was seen, and no rim.
        hides: How far outside of it the outline may hide in what it is softer than the other edge [px].
    """

    profiles: Profiles
    spread: Spread
    line: LineFit
    streaks: float
    plain: bool
    hides: float


def _line(view: FaceView, profiles: Profiles, pose: FloatArray, rounds: int, waves: bool = False) -> LineFit:
    """Line through an edge's points on the plane of the face."""
    y, z = view.points(profiles.pixels).T
    tilt = np.tan(pose[2])
    if profiles.edge == HINGE:
        return fit_line(z, y, profiles.edge_like, (pose[0] + tilt * pose[1], -tilt), rounds, waves)
    return fit_line(y, z, profiles.edge_like, (pose[1] - tilt * pose[0], tilt), rounds, waves)


def _poses(lines: dict[str, LineFit]) -> dict[str, FloatArray]:
    """Pose (y, z, rotation) as each line has it: one corner, but a rotation of its own.

    A right angle is not asked for yet, so that a wrong pair of lines shows as such in the end.
    """
    p, q = lines[HINGE].slope, lines[BOTTOM].slope
    y, z = crossing(lines[HINGE], lines[BOTTOM], p, q)
    return {HINGE: np.array([y, z, -np.arctan(p)]), BOTTOM: np.array([y, z, np.arctan(q)])}


def _moved(view: FaceView, before: dict[str, FloatArray], after: dict[str, FloatArray]) -> float:
    """Largest movement of the edges' ends between two poses [px]."""
    pairs = ((_ends(view, edge, before[edge]), _ends(view, edge, after[edge])) for edge in EDGES)
    return max(abs(one - two) for pair in pairs for one, two in zip(*pair, strict=True)) / view.pixel


def _ends(view: FaceView, edge: str, pose: FloatArray) -> tuple[float, float, float, float]:
    """Of an edge's two ends y and z [m], as numbers: so few of them need no arrays."""
    (y, z, turn), length = pose.tolist(), view.length(edge)
    along = (-sin(turn), cos(turn)) if edge == HINGE else (cos(turn), sin(turn))
    return y, z, y + length * along[0], z + length * along[1]


def _focus(
    picture: ByteArray,
    view: FaceView,
    poses: dict[str, FloatArray],
    room: dict[str, int],
    settings: LocalizerSettings,
) -> tuple[dict[str, FloatArray], dict[str, Profiles], dict[str, LineFit]]:
    """Poses to about half a pixel, with windows as wide as the search leaves open and `room` allows; rows and lines."""
    for _ in range(3):
        wide, lines = {}, {}
        for edge in EDGES:
            weights = plain_weights(room[edge], _WIDE_BLUR if room[edge] == WIDE_HALF else _NARROW_BLUR)
            wide[edge] = measure(picture, view, edge, poses[edge], weights, EVERY)
            checks.check_rows(wide[edge], settings)
            lines[edge] = _line(view, wide[edge], poses[edge], 2)
        before, poses = poses, _poses(lines)
        if _moved(view, before, poses) < _CAUGHT:
            break
    return poses, wide, lines


def _step_aside(
    picture: ByteArray,
    view: FaceView,
    poses: dict[str, FloatArray],
    room: dict[str, int],
    around: dict[str, Neighbourhood],
) -> bool:
    """Whether the edge of the face is another step beside the one found; then `poses` and `room` become its own."""
    lines, here = {}, {}
    for edge in EDGES:
        line = EdgeLine.at_pose(edge, poses[edge], around[edge].step)
        near = [(line.across + distance * view.pixel, step) for distance, step in around[edge].beside]
        others = [replace(line, across=across, step=step) for across, step in near]
        here[edge] = line
        lines[edge] = sorted([*others, line], key=lambda one: -one.across)
    layers = choose(picture, view, lines, poses[HINGE][:2])
    layers.check()
    found = layers.lines
    moved = False
    for i, edge in enumerate(EDGES):
        if found[edge] is here[edge]:
            continue
        move = found[edge].across - here[edge].across
        apart = [abs(a.across - b.across) for a, b in pairwise(lines[edge]) if found[edge] in (a, b)]
        poses[edge] = poses[edge] + [move if i == 0 else 0.0, move if i == 1 else 0.0, 0.0]
        room[edge] = int(np.clip(min(apart) / view.pixel - _WIDE_BLUR, 4, WIDE_HALF))
        moved = True
    return moved


def trace_edges(
    picture: ByteArray, view: FaceView, sighted: Sighted, settings: LocalizerSettings
) -> dict[str, Trace]:
    """Read both edges.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        sighted: Roughly the corner.
        settings: Limits of refusal.

    Raises:
        LocalizationError: NoEdge, WrongEdge, TooFewInliers, Blurred or OverExposed; `marks` are the edges looked at.
    """
    try:
        return _trace(picture, view, sighted, settings)
    except LocalizationError as reason:
        looked_at = [reason.data["edge"]] if "edge" in reason.data else EDGES
        marks = [
            (edge, view.pixels(view.line(edge, sighted.pose, np.linspace(0.0, view.length(edge), 9))))
            for edge in looked_at
        ]
        reason.data.setdefault("marks", tuple(marks))
        raise


def _trace(
    picture: ByteArray, view: FaceView, sighted: Sighted, settings: LocalizerSettings
) -> dict[str, Trace]:
    poses, room = dict.fromkeys(EDGES, sighted.pose), dict.fromkeys(EDGES, WIDE_HALF)
    for _ in range(3):
        poses, around = _surroundings(picture, view, poses, room, settings)
        if not any(beside.beside for beside in around.values()) or not _step_aside(
            picture, view, poses, room, around
        ):
            break
    else:
        raise checks.edge_in_edge()
    reads = _read(picture, view, poses, room, around, settings)
    borders = find_borders(picture, view, reads, settings)
    if any(np.isfinite(one.room) and abs(one.shift) > _ASIDE for one in borders.values()):
        # Between two steps rows scatter: they are read again at the one that is the edge.
        for i, edge in enumerate(EDGES):
            if np.isfinite(borders[edge].room):
                poses[edge] = reads[edge].pose.copy()
                poses[edge][i] -= borders[edge].shift * view.pixel
                room[edge] = int(np.clip(borders[edge].room - _NARROW_BLUR, 4, WIDE_HALF))
        poses, around = _surroundings(picture, view, poses, room, settings)
        reads = _read(picture, view, poses, room, around, settings)
        borders = find_borders(picture, view, reads, settings, borders)
    edges = {
        edge: EdgeLine.at_pose(edge, read.pose, read.profiles.step).moved(-borders[edge].shift * view.pixel)
        for edge, read in reads.items()
    }
    check_again(picture, view, edges, _with_corner_within(picture, view, reads, sighted.lines))
    out = {}
    for edge, read in reads.items():
        check_stretch(picture, view, read.pose, read.profiles, read.line)
        border, beside = borders[edge], read.beside
        line = read.line
        if border.shift:
            line = line.moved(-border.shift * view.pixel, (border.deviation * view.pixel) ** 2)
        pushed = push(beside.face, beside.rows, beside.weights, beside.spread.blur, read.profiles.step)
        line = line.pushed(pushed.place * view.pixel**2, pushed.slope)
        out[edge] = Trace(read.profiles, border.spread, line, read.streaks, not border.shift, border.hides)
    return out


def _with_corner_within(
    picture: ByteArray, view: FaceView, reads: dict[str, EdgeRead], seen: dict[str, list[EdgeLine]]
) -> dict[str, list[EdgeLine]]:
    """The lines that the search saw, and those of a corner within the one found that it did not see."""
    edges = {edge: EdgeLine.at_pose(edge, read.pose, read.profiles.step) for edge, read in reads.items()}
    pose = reads[HINGE].pose
    around = {edge: read.beside for edge, read in reads.items()}
    within = corner_within(picture, view, pose, around, edges)
    corner = {HINGE: float(pose[1]), BOTTOM: float(pose[0])}
    out = dict(seen)
    for edge, line in within.items():
        at = corner[edge]
        if all(abs(line.at(at) - other.at(at)) > _KNOWN for other in seen[edge]):
            out[edge] = sorted([*seen[edge], line], key=lambda one: -one.at(at))
    return out


def _surroundings(
    picture: ByteArray,
    view: FaceView,
    poses: dict[str, FloatArray],
    room: dict[str, int],
    settings: LocalizerSettings,
) -> tuple[dict[str, FloatArray], dict[str, Neighbourhood]]:
    """Poses to about half a pixel, and what lies beside the edges."""
    found = _focus(picture, view, poses, room, settings)
    return found[0], _around(picture, view, *found)


def _around(
    picture: ByteArray,
    view: FaceView,
    poses: dict[str, FloatArray],
    wide: dict[str, Profiles],
    lines: dict[str, LineFit],
) -> dict[str, Neighbourhood]:
    """What lies beside the edges, by what was found in focusing."""
    return {edge: look_around(picture, view, poses[edge], wide[edge], lines[edge]) for edge in EDGES}


def _read(
    picture: ByteArray,
    view: FaceView,
    poses: dict[str, FloatArray],
    room: dict[str, int],
    around: dict[str, Neighbourhood],
    settings: LocalizerSettings,
) -> dict[str, EdgeRead]:
    """Every row of both edges, read as the surroundings ask for."""
    for _ in range(4):
        profiles, lines = {}, {}
        for edge, beside in around.items():
            profiles[edge] = measure(picture, view, edge, poses[edge], beside.weights)
            checks.check_rows(profiles[edge], settings)
            lines[edge] = _line(view, profiles[edge], poses[edge], 4, isfinite(settings.straightness_limit))
        before, poses = poses, _poses(lines)
        moved = _moved(view, before, poses)
        if moved < _NEAR:
            break
        if moved > _FAR:
            found = _focus(picture, view, poses, room, settings)
            if _moved(view, before, found[0]) < _SAME:
                break  # wide windows lead back to where these rows were read
            poses, around = found[0], _around(picture, view, *found)
    poses, lines = _poses(lines), pooled(lines)
    for edge in EDGES:
        checks.check_share(edge, share(lines[edge].inliers), settings)
    return {edge: EdgeRead(poses[edge], profiles[edge], lines[edge], around[edge]) for edge in EDGES}
