"""Camera matrix and lens distortion from pictures of a chessboard (thesis sections 2.3 and 3.7)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from doormill_ros.arrays import Float32Array, FloatArray
from doormill_ros.localization.calibration.board_shape import BoardShape, ShapeModel, board_shape, shape_model
from doormill_ros.localization.calibration.bundle import Bundle, fit_bundle
from doormill_ros.localization.calibration.chessboard import Chessboard
from doormill_ros.localization.calibration.errors import PoorlySpread, TooFewPictures
from doormill_ros.statistics import NORMAL_STD

_FEWEST = 6
_BAD = 3.5  # robust standard deviations of the pictures' errors above their median
_LEAST_BAD = 2.5  # and at least this many times the median: far and near boards differ by two
_MAX_DEVIATION = 0.02  # of the focal length
_STOP = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-12)


@dataclass(frozen=True, eq=False)
class Intrinsics:
    """Outcome of `calibrate_intrinsics`.

    Attributes:
        k: Camera matrix [px], shape (3, 3).
        distortion: k1, k2, p1, p2, k3, shape (5,).
        k_deviation: Standard deviations of fx, fy, cx, cy [px], shape (4,).
        distortion_deviation: Standard deviations of the distortion, shape (5,); 0 where held at 0.
        covariance: Of fx, fy, cx, cy and the distortion, shape (9, 9).
        shape: The board as the pictures have it.
        scatter: How much more than their noise the pictures disagree, as a ratio of standard deviations; see `bundle`.
        size: Picture width and height [px].
        picture_error: RMS reprojection error of each picture [px], shape (n,); nan where no corners came.
            Rejected pictures are measured against the calibration without them.
        used: Which pictures the result rests on, shape (n,), bool.
        error: RMS reprojection error of the used pictures [px].
        covered: Largest distance of a used corner from the principal point, at unit focal length.
    """

    k: FloatArray
    distortion: FloatArray
    k_deviation: FloatArray
    distortion_deviation: FloatArray
    covariance: FloatArray
    shape: BoardShape
    scatter: float
    size: tuple[int, int]
    picture_error: FloatArray
    used: FloatArray
    error: float
    covered: float


def calibrate_intrinsics(
    corners: list[FloatArray | None], board: Chessboard, size: tuple[int, int], radial: int = 2
) -> Intrinsics:
    """Calibrate, and leave out pictures whose error stands out from the others.

    Bad pictures go one at a time, the worst first, because each spoils the errors of the others.

    Args:
        corners: For each picture the corners (m, 2) [px], or None when the board was not found.
        board: The chessboard.
        size: Picture width and height [px].
        radial: How many radial coefficients to fit, 1 to 3; the others stay 0.

    Raises:
        BadCalibrationFile: The board is square.
        TooFewPictures: Fewer than six pictures are usable.
        PoorlySpread: The pictures do not determine the camera.
    """
    model = shape_model(board)
    points = board.points().astype(np.float32)
    used = np.array([c is not None for c in corners])
    while True:
        if used.sum() < _FEWEST:
            raise TooFewPictures(
                f"{used.sum()} of {len(corners)} pictures are usable, at least {_FEWEST} are needed; take more",
                usable=int(used.sum()),
            )
        seen = [c.astype(np.float32) for c, use in zip(corners, used, strict=True) if use and c is not None]
        fit = _fit(points, seen, size, radial)
        errors = fit[7].ravel()
        centre = float(np.median(errors))
        scatter = NORMAL_STD * float(np.median(np.abs(errors - centre)))
        worst = int(np.argmax(errors))
        if errors[worst] <= max(centre + _BAD * scatter, _LEAST_BAD * centre):
            break
        used[np.flatnonzero(used)[worst]] = False
    bundle = _bundle(fit, seen, model, radial)
    deviation = np.sqrt(np.diag(bundle.covariance))
    k, distortion = _camera(bundle.camera)
    # OpenCV's own deviations stay small when the focal length runs away, these do not.
    if not np.all(np.isfinite(deviation)) or np.any(deviation[:2] > _MAX_DEVIATION * k[(0, 1), (0, 1)]):
        raise PoorlySpread(
            f"{len(seen)} pictures leave the focal length open: {k[0, 0]:.0f} px with a standard deviation of "
            f"{deviation[0]:.0f} px, allowed are {_MAX_DEVIATION:.0%}; take pictures with the board tilted in "
            "both directions",
        )
    bent = model.bent(bundle.shape)
    rays = cv2.undistortPoints(np.concatenate(seen).reshape(-1, 1, 2), k, distortion)[:, 0]
    return Intrinsics(
        k=k,
        distortion=distortion,
        k_deviation=deviation[:4],
        distortion_deviation=deviation[4:9],
        covariance=bundle.covariance,
        shape=board_shape(model, bundle.shape, bundle.shape_covariance),
        scatter=bundle.scatter,
        size=size,
        picture_error=np.array([_error(bent, c, k, distortion) for c in corners]),
        used=used,
        error=bundle.error,
        covered=float(np.linalg.norm(rays, axis=1).max()),
    )


def check_corner(found: Intrinsics) -> None:
    """Refuse a lens whose distortion was seen so near the middle that it leaves the picture's corner open.

    Raises:
        PoorlySpread: The place of a ray to the corner is uncertain by more than what is allowed of the focal length.
    """
    width, height = found.size
    corners = np.array([[0, 0], [width, 0], [0, height], [width, height]], dtype=float)
    rays = np.column_stack([(corners - found.k[:2, 2]) / found.k[[0, 1], [0, 1]], np.ones(4)])
    nowhere = np.zeros(3)
    by_lens = cv2.projectPoints(rays, nowhere, nowhere, found.k, found.distortion)[1][:, 6:15]
    variances = np.einsum("ij,jk,ik->i", by_lens, found.covariance, by_lens)
    deviation, most = float(np.sqrt(variances.max())), _MAX_DEVIATION * float(found.k[0, 0])
    if not deviation <= most:
        raise PoorlySpread(
            f"the pictures leave open where a ray to the picture's corner lands, by {deviation:.0f} px, allowed are "
            f"{most:.0f} px; show the board in the corners, or fit fewer radial coefficients with --radial"
        )


def _fit(
    points: Float32Array, seen: list[Float32Array], size: tuple[int, int], radial: int
) -> tuple[Any, ...]:  # as OpenCV, which has no types, gives it
    flags = 0
    for count, flag in ((1, cv2.CALIB_FIX_K2), (2, cv2.CALIB_FIX_K3)):
        flags |= flag if radial <= count else 0
    try:
        fit: tuple[Any, ...] = cv2.calibrateCameraExtended(
            [points] * len(seen), seen, size, None, None, flags=flags, criteria=_STOP
        )
    except cv2.error as error:
        raise PoorlySpread(
            f"{len(seen)} pictures do not determine the camera ({error.err}); take pictures with the board "
            "tilted in both directions"
        ) from error
    return fit


def _bundle(fit: tuple[Any, ...], seen: list[Float32Array], model: ShapeModel, radial: int) -> Bundle:
    k, distortion = fit[1], fit[2].ravel()[:5]
    start = np.array([k[0, 0], k[1, 1], k[0, 2], k[1, 2], *distortion])
    held = np.array([False] * 5 + [radial < 2, False, False, radial < 3])
    # OpenCV's places are those of the first corner, here it is the middle.
    middle = -model.points[0]
    places = [
        (turn, place.ravel() + cv2.Rodrigues(turn)[0] @ middle)
        for turn, place in zip(fit[3], fit[4], strict=True)
    ]
    return fit_bundle(model, [c.astype(float) for c in seen], start, places, held)


def _camera(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """K (3, 3) and distortion (5,) of the nine numbers of a `Bundle`."""
    fx, fy, cx, cy = values[:4]
    return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]), values[4:].copy()


def _error(points: FloatArray, corners: FloatArray | None, k: FloatArray, distortion: FloatArray) -> float:
    """RMS distance [px] of corners from where a camera sees the board, best placed."""
    if corners is None:
        return float("nan")
    found, rotation, shift = cv2.solvePnP(points, corners, k, distortion)
    if not found:
        return float("nan")
    again = cv2.projectPoints(points, rotation, shift, k, distortion)[0][:, 0]
    return float(np.sqrt(np.mean(np.sum((again - corners) ** 2, axis=1))))
