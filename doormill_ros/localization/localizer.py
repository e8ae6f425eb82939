"""From a picture to the pose of the door, or to the reason why not."""

from __future__ import annotations

import numpy as np

from doormill_ros.cell.layout import CellLayout, DoorOffset
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.coarse import search
from doormill_ros.localization.errors import (
    BadPicture,
    CameraInfoMissing,
    CameraInfoSize,
    NoEdge,
    OutOfRange,
    StalePicture,
)
from doormill_ros.localization.fit import fit_pose
from doormill_ros.localization.profiles import measure
from doormill_ros.localization.result import EdgeTrace, Localization
from doormill_ros.localization.view import BOTTOM, HINGE, face_view
from doormill_ros.units import m_to_mm, rad_to_deg

MAX_AGE = 2.0  # s


def localize(
    picture: np.ndarray,
    camera: CameraModel | None,
    layout: CellLayout,
    width: float,
    thickness: float,
    *,
    age: float = 0.0,
) -> Localization:
    """Find the door in one picture.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        camera: The camera with the picture's intrinsics; None when none came with it.
        layout: Where the nominal door stands and how far it may be off.
        width: Door width [m].
        thickness: Door thickness [m].
        age: Time since the picture was taken [s].

    Raises:
        LocalizationError: One of its leaves, the reason for a refusal.
    """
    if camera is None:
        raise CameraInfoMissing(
            "no camera info came with the picture; start the camera's driver with its calibration"
        )
    if picture.ndim != 2 or picture.dtype != np.uint8:
        raise BadPicture(
            f"picture has shape {picture.shape} and type {picture.dtype}, allowed is (h, w) uint8"
        )
    if picture.shape != (camera.size[1], camera.size[0]):
        raise CameraInfoSize(
            f"camera info is for {camera.size[0]} x {camera.size[1]} px, the picture has "
            f"{picture.shape[1]} x {picture.shape[0]} px; set the camera to the size it was calibrated with"
        )
    if age > MAX_AGE:
        raise StalePicture(
            f"the picture is {age:.1f} s old, allowed are {MAX_AGE:.1f} s; take a new one", age=age
        )
    view = face_view(camera, layout, float(width), float(thickness))
    limits = layout.limits
    pose = search(picture, view, max(limits.y, limits.z) + 3.5e-3, limits.rotation + 0.005)
    for blur, half in ((2.0, 10), (1.2, 8)):
        profiles = [measure(picture, view, edge, pose, blur, half) for edge in (HINGE, BOTTOM)]
        points = [view.points(p.pixels) for p in profiles]
        fit = fit_pose(*points, pose)
        pose = fit.pose
    if min(abs(float(np.median(p.contrast))) for p in profiles) < 6.0:
        raise NoEdge("no edge of the door stands out of the picture; look at the door and the light")
    offset = DoorOffset(*(float(v) for v in pose))
    if abs(offset.y) > limits.y or abs(offset.z) > limits.z or abs(offset.rotation) > limits.rotation:
        raise OutOfRange(
            f"the door stands {m_to_mm(offset.y):+.2f} mm, {m_to_mm(offset.z):+.2f} mm and "
            f"{rad_to_deg(offset.rotation):+.2f} degrees off, allowed are {m_to_mm(limits.y):.0f} mm and "
            f"{rad_to_deg(limits.rotation):.0f} degrees; place it again"
        )
    traces = tuple(
        EdgeTrace(
            edge,
            profile.pixels,
            inlier,
            view.pixels(view.line(edge, pose, np.linspace(0, 1.1 * view.length(edge), 40))),
            float(np.sqrt(np.mean(residual[inlier] ** 2))),
            float(np.median(profile.contrast)),
            1.2,
        )
        for edge, profile, residual, inlier in zip(
            (HINGE, BOTTOM), profiles, fit.residuals, fit.inliers, strict=True
        )
    )
    inlier = np.concatenate(fit.inliers)
    residual = np.concatenate(fit.residuals)[inlier]
    return Localization(
        layout.T_base_door(width, thickness, offset),
        offset,
        fit.covariance,
        float(np.sqrt(np.mean(residual**2))),
        float(inlier.mean()),
        float(inlier.mean()),
        view.pixels(pose[:2]),
        traces,
    )
