"""From a rough pose to the two fitted edges: focus in, learn the surroundings, read every row."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.localization import checks
from doormill_ros.localization.blur import Spread, edge_spread
from doormill_ros.localization.fit import LineFit, fit_line, fit_pose
from doormill_ros.localization.profiles import Profiles, crossing, gather, measure, plain_weights
from doormill_ros.localization.settings import LocalizerSettings
from doormill_ros.localization.texture import push, step_weights, streaks, variogram
from doormill_ros.localization.view import BOTTOM, EDGES, HINGE, FaceView

_WIDE_BLUR, _WIDE_HALF = 3.0, 12  # px; wide enough to catch an edge four pixels from where the search has it
_EVERY = 4  # rows left out while focusing in
_NEAR = 0.3  # px; focusing in ends when the edges move by less
_REACH = 2.5  # pixels looked at on each side of an edge, in standard deviations of its blur
_FACE_STRIP, _BACK_STRIP = 40, 12  # px; surfaces beside an edge whose texture is learned
_FREE_ANGLE = 1.0  # rad; so little is known of the right angle that a wrong pair of lines shows as such


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


def _line(view: FaceView, profiles: Profiles, pose: np.ndarray) -> LineFit:
    """Line through an edge's points on the plane of the face."""
    y, z = view.points(profiles.pixels).T
    tilt = np.tan(pose[2])
    if profiles.edge == HINGE:
        return fit_line(z, y, profiles.edge_like, (pose[0] + tilt * pose[1], -tilt))
    return fit_line(y, z, profiles.edge_like, (pose[1] - tilt * pose[0], tilt))


def _moved(view: FaceView, before: np.ndarray, after: np.ndarray) -> float:
    """Largest movement of the edges' ends between two poses [px]."""
    ends = np.array([0.0, view.length(BOTTOM)])
    return float(np.abs(view.line(BOTTOM, after, ends) - view.line(BOTTOM, before, ends)).max() / view.pixel)


def _spread(picture: np.ndarray, view: FaceView, edge: str, pose: np.ndarray) -> Spread:
    """Blur of an edge that runs where `pose` says."""
    profiles = measure(picture, view, edge, pose, plain_weights(_WIDE_HALF, _WIDE_BLUR), _EVERY)
    return edge_spread(profiles, profiles.place, profiles.edge_like)


def _weights(
    picture: np.ndarray, view: FaceView, edge: str, pose: np.ndarray, blur: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Weights for an edge's rows as the textures beside it ask for; the strip of face beside it, its rows."""
    half = int(np.clip(np.ceil(_REACH * blur + 2.0), 4, 14))
    lines, at = crossing(view, edge, pose, half, 2.0e-3)
    lines, at = lines[::_EVERY], at[::_EVERY]
    gap = int(np.ceil(3.0 * blur)) + 2
    span = np.arange(-gap - _FACE_STRIP, gap + _BACK_STRIP + 1)
    values = gather(picture, edge, lines, np.rint(at).astype(np.intp), span).astype(np.float32)
    strip = values[:, :_FACE_STRIP]
    inside, outside = variogram(strip, 2 * half), variogram(values[:, -_BACK_STRIP:], 2 * half)
    return step_weights(half, blur, inside, outside), strip, lines


def _focus(picture: np.ndarray, view: FaceView, pose: np.ndarray, settings: LocalizerSettings) -> np.ndarray:
    """Pose to a fraction of a pixel, first with wide windows, then with windows as sharp as the edge."""
    for sharp in (False, True):
        for _ in range(3):
            lines = {}
            for edge in EDGES:
                if sharp:
                    weights = _weights(picture, view, edge, pose, _spread(picture, view, edge, pose).blur)[0]
                else:
                    weights = plain_weights(_WIDE_HALF, _WIDE_BLUR)
                profiles = measure(picture, view, edge, pose, weights, _EVERY)
                checks.check_rows(profiles, settings)
                lines[edge] = _line(view, profiles, pose)
            before, pose = pose, fit_pose(lines[HINGE], lines[BOTTOM], _FREE_ANGLE).pose
            if _moved(view, before, pose) < _NEAR:
                break
    return pose


def trace_edges(
    picture: np.ndarray, view: FaceView, pose: np.ndarray, settings: LocalizerSettings
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
    pose = _focus(picture, view, pose, settings)
    out = {}
    for edge in EDGES:
        spread = _spread(picture, view, edge, pose)
        weights, strip, rows = _weights(picture, view, edge, pose, spread.blur)
        profiles = measure(picture, view, edge, pose, weights)
        checks.check_rows(profiles, settings)
        checks.check_spread(edge, spread, streaks(strip) / abs(profiles.step), settings)
        line = _line(view, profiles, pose)
        checks.check_share(edge, float(line.inliers.mean()), settings)
        pushed = push(strip, rows, weights, spread.blur, profiles.step)
        out[edge] = Trace(profiles, spread, line.pushed(pushed.place * view.pixel**2, pushed.slope))
    return out
