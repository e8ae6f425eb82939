"""From a picture to the pose of the door, or to the reason why not."""

from __future__ import annotations

import numpy as np

from doormill_ros.cell.layout import CellLayout, DoorOffset
from doormill_ros.localization import checks
from doormill_ros.localization.blur import Spread, edge_spread
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.coarse import search
from doormill_ros.localization.errors import LocalizationError, NoEdge, WrongEdge
from doormill_ros.localization.fit import LineFit, PoseFit, fit_line, fit_pose
from doormill_ros.localization.profiles import Profiles, measure
from doormill_ros.localization.result import EdgeTrace, Localization
from doormill_ros.localization.settings import LocalizerSettings, shipped_settings
from doormill_ros.localization.view import BOTTOM, EDGES, HINGE, FaceView, face_view

_FIRST_BLUR, _FIRST_HALF = 3.0, 12  # wide enough to catch an edge four pixels from where the search has it
_FIRST_EVERY = 4
_NEAR = 1.0  # px; a first fit that moved further is repeated
_WIDE = 2.5  # factor on the limits when looking for a door that stands out of range


def localize(
    picture: np.ndarray,
    camera: CameraModel | None,
    layout: CellLayout,
    width: float,
    thickness: float,
    *,
    age: float = 0.0,
    settings: LocalizerSettings | None = None,
) -> Localization:
    """Find the door in one picture.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        camera: The camera with the picture's intrinsics; None when none came with it.
        layout: Where the nominal door stands and how far it may be off.
        width: Door width [m].
        thickness: Door thickness [m].
        age: Time since the picture was taken [s].
        settings: Limits of refusal; None for those of config/camera.yaml.

    Raises:
        LocalizationError: One of its leaves, the reason for a refusal.
    """
    settings = settings or shipped_settings()
    checks.check_input(picture, camera, age, settings)
    checks.check_exposure(picture)
    view = face_view(camera, layout, float(width), float(thickness))
    pose = _rough_pose(picture, view, layout)
    pose = _first_fit(picture, view, pose, settings)
    spreads = _spreads(picture, view, pose, settings)
    profiles, lines = {}, {}
    for edge in EDGES:
        blur = spreads[edge].blur
        half = int(np.clip(np.ceil(3.0 * blur + 2.0), 5, 14))
        profiles[edge] = measure(picture, view, edge, pose, blur, half)
        checks.check_rows(profiles[edge], settings)
        lines[edge] = _line(view, profiles[edge], pose)
        checks.check_share(edge, float(lines[edge].inliers.mean()), settings)
    fit = fit_pose(lines[HINGE], lines[BOTTOM], settings.squareness)
    checks.check_square(fit)
    offset = DoorOffset(*(float(v) for v in fit.pose))
    checks.check_range(offset, layout.limits)
    covariance = _covariance(fit, view, settings)
    checks.check_certainty(covariance, (lines[HINGE], lines[BOTTOM]), settings)
    return _result(view, layout, (width, thickness), fit, covariance, profiles, lines, spreads, settings)


def _rough_pose(picture: np.ndarray, view: FaceView, layout: CellLayout) -> np.ndarray:
    """Pose to about a pixel; when there is none, the most telling reason."""
    limit, rotation = max(layout.limits.y, layout.limits.z), layout.limits.rotation
    try:
        return search(picture, view, limit, rotation)
    except (NoEdge, WrongEdge) as reason:
        checks.check_exposure(picture, strict=True)
        try:
            pose = search(picture, view, _WIDE * limit, _WIDE * rotation)
        except LocalizationError:
            raise reason from None
        checks.check_range(DoorOffset(*(float(v) for v in pose)), layout.limits)
        raise


def _line(view: FaceView, profiles: Profiles, pose: np.ndarray) -> LineFit:
    """Line through an edge's points on the plane of the face."""
    y, z = view.points(profiles.pixels).T
    tilt = np.tan(pose[2])
    if profiles.edge == HINGE:
        return fit_line(z, y, profiles.edge_like, (pose[0] + tilt * pose[1], -tilt))
    return fit_line(y, z, profiles.edge_like, (pose[1] - tilt * pose[0], tilt))


def _first_fit(
    picture: np.ndarray, view: FaceView, pose: np.ndarray, settings: LocalizerSettings
) -> np.ndarray:
    """Pose to a fraction of a pixel from every fourth row, whatever the blur."""
    for _ in range(3):
        before = pose
        lines = {}
        for edge in EDGES:
            profiles = measure(picture, view, edge, pose, _FIRST_BLUR, _FIRST_HALF, _FIRST_EVERY)
            if profiles.edge_like.sum() < 8:
                checks.check_rows(profiles, settings)
            lines[edge] = _line(view, profiles, pose)
        # The angle between the lines is left free here: a wrong pair of lines must show as such.
        pose = fit_pose(lines[HINGE], lines[BOTTOM], 1.0).pose
        ends = np.array([0.0, view.length(BOTTOM)])
        moved = view.line(BOTTOM, pose, ends) - view.line(BOTTOM, before, ends)
        if np.abs(moved).max() < _NEAR * view.pixel:
            break
    return pose


def _spreads(
    picture: np.ndarray, view: FaceView, pose: np.ndarray, settings: LocalizerSettings
) -> dict[str, Spread]:
    """Blur of both edges."""
    out = {}
    for edge in EDGES:
        profiles = measure(picture, view, edge, pose, _FIRST_BLUR, _FIRST_HALF, _FIRST_EVERY)
        checks.check_rows(profiles, settings)
        out[edge] = edge_spread(profiles, profiles.place, profiles.edge_like)
        checks.check_spread(edge, out[edge], settings)
    return out


def _covariance(fit: PoseFit, view: FaceView, settings: LocalizerSettings) -> np.ndarray:
    """Covariance of the pose with what the picture cannot tell."""
    sight = np.array([*view.sight(fit.pose[:2]), 0.0])  # shift of the corner per distance of the face
    return (
        fit.covariance
        + np.diag(np.square(settings.mounting_deviation))
        + settings.thickness_deviation**2 * np.outer(sight, sight)
    )


def _result(
    view: FaceView,
    layout: CellLayout,
    size: tuple[float, float],
    fit: PoseFit,
    covariance: np.ndarray,
    profiles: dict[str, Profiles],
    lines: dict[str, LineFit],
    spreads: dict[str, Spread],
    settings: LocalizerSettings,
) -> Localization:
    offset = DoorOffset(*(float(v) for v in fit.pose))
    traces = tuple(
        EdgeTrace(
            edge,
            profiles[edge].pixels,
            lines[edge].inliers,
            view.pixels(view.line(edge, fit.pose, np.linspace(0.0, view.length(edge) + 0.02, 60))),
            lines[edge].scatter,
            profiles[edge].step,
            spreads[edge].blur,
        )
        for edge in EDGES
    )
    inlier = np.concatenate([line.inliers for line in lines.values()])
    residual = np.concatenate([line.residuals for line in lines.values()])[inlier]
    worst = min(float(line.inliers.mean()) for line in lines.values())
    margins = [
        (worst - settings.min_inlier_share) / (1 - settings.min_inlier_share),
        1 - max(s.blur for s in spreads.values()) / settings.max_blur,
        1 - float(np.max(np.sqrt(np.diag(covariance)) / settings.max_deviation)),
    ]
    return Localization(
        layout.T_base_door(*size, offset),
        offset,
        covariance,
        float(np.sqrt(np.mean(residual**2))),
        float(inlier.mean()),
        float(np.clip(min(margins), 0.0, 1.0)),
        view.pixels(fit.pose[:2]),
        traces,
    )
