"""From a picture to the pose of the door, or to the reason why not."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray, IntArray
from doormill_ros.cell.places.layout import CellLayout, DoorOffset
from doormill_ros.localization import checks
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.empty_clamp.clamp_lines import FaceInClamp, check_clamp, smoothed
from doormill_ros.localization.empty_clamp.empty_clamp import EmptyClamp, empty_clamp_for
from doormill_ros.localization.empty_clamp.stale_clamp import clamp_pattern, fit_clamp
from doormill_ros.localization.errors import LocalizationError, NoEdge, WrongEdge
from doormill_ros.localization.lines.fit import CornerFit, fit_corner
from doormill_ros.localization.lines.straightness import check_straight
from doormill_ros.localization.marks.drift import Drift, drift_in
from doormill_ros.localization.marks.marked_view import marked_view
from doormill_ros.localization.result import CovarianceParts, EdgeTrace, Localization
from doormill_ros.localization.rims.crossing import check_crossing
from doormill_ros.localization.rims.processing import check_levels, level_counts
from doormill_ros.localization.rims.sharpness import check_hidden, check_sharpness
from doormill_ros.localization.search.band import reduced
from doormill_ros.localization.search.beyond import larger_beyond
from doormill_ros.localization.search.coarse import Sighted, search, search_bands
from doormill_ros.localization.settings import LocalizerSettings, shipped_settings
from doormill_ros.localization.tracing import Trace, trace_edges
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView, face_view
from doormill_ros.statistics import root_mean_square

_WIDE = 2.5  # factor on the limits when looking for a door that stands out of range


def localize(
    picture: ByteArray,
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
        thickness: Door thickness [m]; gives the distance and with it the scale, thesis section 3.7.
        age: Time since the picture was taken [s].
        settings: Limits of refusal; None for those of config/camera.yaml.

    Raises:
        LocalizationError: One of its leaves, the reason for a refusal.
    """
    settings = settings or shipped_settings()
    checks.check_input(picture, camera, age, settings)
    counts = level_counts(picture)
    checks.check_exposure(counts)
    check_levels(counts)
    checks.check_face(width, thickness)
    view = face_view(camera, layout, float(width), float(thickness))
    checks.check_view(view.pixel)
    drift = drift_in(picture, camera, float(width), layout.T_base_door(width, thickness)[:3, 3])
    traces = trace_edges(picture, view, _sighted(picture, counts, view, layout), settings)
    fit = fit_corner(traces[HINGE].line, traces[BOTTOM].line, settings.squareness, settings.squareness_limit)
    clamp = empty_clamp_for(view.camera.empty, float(width))
    clamp_fit = None
    if clamp is not None:
        whole = _whole_sensor(view.camera, clamp)
        seen = face_view(whole, layout, float(width), float(thickness))
        clamp_fit = fit_clamp(picture, view.camera, clamp, seen, fit.pose)
        check_clamp(FaceInClamp(picture, view, clamp, seen, fit.pose, clamp_fit))
    checks.check_square(fit, {edge: trace.streaks for edge, trace in traces.items()}, settings)

    def drawn(edge: str) -> FloatArray:
        return view.pixels(view.line(edge, fit.pose, np.linspace(0.0, view.length(edge), 9)))

    blurs = {edge: trace.spread.blur for edge, trace in traces.items()}
    check_sharpness(blurs, view, fit, drawn, settings)
    check_hidden({edge: trace.hides for edge, trace in traces.items()}, view)
    if all(trace.plain for trace in traces.values()):
        check_crossing(picture, view, fit.pose, min(blurs.values()))
    offset = _offset_of(fit.pose)
    checks.check_range(offset, layout.limits)
    check_straight({edge: trace.line for edge, trace in traces.items()}, drawn, settings)
    # A better picture cannot help against a wrong thickness or mounting: only the picture's own part is judged.
    checks.check_certainty(fit.covariance, traces[HINGE].line, traces[BOTTOM].line, settings)
    inlier = np.concatenate([t.line.inliers for t in traces.values()])
    residual = np.concatenate([t.line.residuals for t in traces.values()])[inlier]
    return Localization(
        T_base_door=layout.T_base_door(width, thickness, offset),
        offset=offset,
        parts=_parts(fit, view, settings, drift),
        residual=root_mean_square(residual),
        inlier_share=float(inlier.mean()),
        quality=_quality(traces, fit.covariance, settings),
        corner=view.pixels(fit.pose[:2]),
        pixel=float(view.pixel),
        edges=(_edge_trace(view, traces[HINGE], fit), _edge_trace(view, traces[BOTTOM], fit)),
        drift=drift,
        clamp=clamp_fit,
    )


def prepare(camera: CameraModel, layout: CellLayout, width: float, thickness: float) -> None:
    """Work out what depends on the door's size only, so that its picture need not wait for it; see `localize`.

    Raises:
        LocalizationError: BadDoorFace or BadCameraInfo.
    """
    checks.check_face(width, thickness)
    view = face_view(camera, layout, float(width), float(thickness))
    checks.check_view(view.pixel)
    search_bands(view, max(layout.limits.y, layout.limits.z), layout.limits.rotation)
    if camera.marks is not None:
        marked_view(camera, camera.marks, float(width))
    clamp = empty_clamp_for(camera.empty, float(width))
    if clamp is not None:
        smoothed(clamp)
        clamp_pattern(clamp)
        face_view(_whole_sensor(camera, clamp), layout, float(width), float(thickness))


@lru_cache(maxsize=8)
def _whole_sensor(camera: CameraModel, clamp: EmptyClamp) -> CameraModel:
    """The camera as it took the empty clamp, whatever part of its sensor it sends now."""
    height, width = clamp.picture.shape
    return camera.with_intrinsics(clamp.k, clamp.distortion, (width, height))


def _sighted(picture: ByteArray, counts: IntArray, view: FaceView, layout: CellLayout) -> Sighted:
    """The corner to about a pixel in a picture of such `level_counts`; when there is none, the most telling reason."""
    limit, rotation = max(layout.limits.y, layout.limits.z), layout.limits.rotation
    small = reduced(picture)
    try:
        found = search(picture, small, view, limit, rotation)
    except (NoEdge, WrongEdge) as reason:
        checks.check_exposure(counts, strict=True)
        try:
            further = search(picture, small, view, _WIDE * limit, _WIDE * rotation, broken=False)
        except LocalizationError:
            raise reason from None
        checks.check_range(_offset_of(further.pose), layout.limits, sure=False)
        raise
    if larger_beyond(picture, view, found.pose):
        try:
            further = search(picture, small, view, _WIDE * limit, _WIDE * rotation)
        except (NoEdge, WrongEdge):
            checks.check_exposure(counts, strict=True)
            raise
        checks.check_range(_offset_of(further.pose), layout.limits, sure=False)
    return found


def _offset_of(pose: FloatArray) -> DoorOffset:
    """A pose, shape (3,), as what the door is off."""
    return DoorOffset(*(float(v) for v in pose))


def _parts(
    fit: CornerFit, view: FaceView, settings: LocalizerSettings, drift: Drift | None
) -> CovarianceParts:
    """Covariance of the pose from the picture, and from what it cannot tell."""
    sight = np.array([*view.sight(fit.pose[:2]), 0.0])  # shift of the corner per distance of the face
    across = np.outer(sight, sight)
    lens = (settings.lens_deviation * view.distance) ** 2 * across
    moved = np.zeros((3, 3)) if drift is None else np.outer(drift.door, drift.door)
    return CovarianceParts(
        scatter=fit.covariance,
        shape=settings.straightness_deviation**2 * np.diag([1.0, 1.0, 0.0]),
        thickness=settings.thickness_deviation**2 * across,
        calibration=np.diag(np.square(settings.mounting_deviation)) + lens + moved,
    )


def _quality(traces: dict[str, Trace], covariance: FloatArray, settings: LocalizerSettings) -> float:
    """Smallest distance from a limit of refusal, 0..1."""
    share = min(float(t.line.inliers.mean()) for t in traces.values())
    blur = max(t.spread.blur for t in traces.values())
    margins = [
        (share - settings.min_inlier_share) / (1 - settings.min_inlier_share),
        1 - blur / settings.max_blur,
        1 - float(np.max(np.sqrt(np.diag(covariance)) / settings.max_deviation)),
    ]
    return float(np.clip(min(margins), 0.0, 1.0))


def _edge_trace(view: FaceView, trace: Trace, fit: CornerFit) -> EdgeTrace:
    edge = trace.profiles.edge
    return EdgeTrace(
        name=edge,
        pixels=trace.profiles.pixels,
        inlier=trace.line.inliers,
        line=view.pixels(view.line(edge, fit.pose, np.linspace(0.0, view.length(edge) + 0.02, 60))),
        residual=trace.line.scatter,
        contrast=trace.profiles.step,
        blur=trace.spread.blur,
    )
