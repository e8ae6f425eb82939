"""Camera, boards' places and the board's shape, fitted together to all corners.

A board that is bowed or stretched by tenths of a millimetre moves focal length and distortion by many times what
the corners' noise does, with residuals that hardly grow. Its shape is therefore unknown too (as in Strobl and
Hirzinger, "More accurate camera and hand-eye calibrations with unknown grid pattern dimensions", 2008), held by what
boards are usually like; what pictures do not tell of it is in the covariance. What is left, the corners of one picture
off together, shows as scatter between calibrations that leave out one picture each.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.localization.calibration.board_shape import ShapeModel

CAMERA = 9  # fx, fy, cx, cy, k1, k2, p1, p2, k3
_STEPS = 30
_DONE = 1e-6  # standard deviations
_FARTHEST = 0.5  # step of a focal length, as a share of it, with which the fit has run away
_OPEN = 1e-12  # ratio of eigenvalues at which the pictures leave a parameter open
_NOTHING = 1e-100  # information that is none
_FINEST = 1e-6  # px, noise of corners without any


@dataclass(frozen=True, eq=False)
class Bundle:
    """Outcome of `fit_bundle`.

    Attributes:
        camera: fx, fy, cx, cy [px], k1, k2, p1, p2, k3, shape (9,).
        covariance: Of it, shape (9, 9); nan where the pictures leave it open, 0 where held.
        shape: Parameters of the board's shape, shape (m,).
        shape_covariance: Of these, shape (m, m).
        error: RMS distance of a corner [px].
        scatter: Largest ratio of a parameter's standard deviation from leaving out pictures to the one from noise.
    """

    camera: FloatArray
    covariance: FloatArray
    shape: FloatArray
    shape_covariance: FloatArray
    error: float
    scatter: float


@dataclass(frozen=True, eq=False)
class _Picture:
    """One picture's share of the normal equations, its board's place eliminated; all in px."""

    normal: FloatArray
    gradient: FloatArray
    squares: float
    place_step: FloatArray  # of the place, without a step of the others
    place_coupling: FloatArray


def fit_bundle(
    model: ShapeModel,
    seen: list[FloatArray],
    start: FloatArray,
    places: list[tuple[FloatArray, FloatArray]],
    held: BoolArray,
) -> Bundle:
    """Gauss-Newton from an ordinary calibration.

    Args:
        model: The board.
        seen: Corners of each picture (n, 2) [px].
        start: Camera, shape (9,), see `Bundle`.
        places: Rotation vector and place of the board's middle in camera axes for each picture, shape (3,) each.
        held: Which of the nine stay as they are, shape (9,), bool.
    """
    camera, shape = start.astype(float), np.zeros(len(model.expected))
    poses = [np.concatenate([np.ravel(turn), np.ravel(place)]).astype(float) for turn, place in places]
    free: BoolArray = np.concatenate([~held, np.ones(len(shape), bool)])
    count = sum(2 * len(s) - 6 for s in seen) - int(np.sum(~held))
    expected = np.zeros(len(free))
    expected[CAMERA:] = 1.0 / model.expected**2
    for _ in range(_STEPS):
        parts = [_linearise(model, c, camera, shape, p) for c, p in zip(seen, poses, strict=True)]
        noise = max(sum(p.squares for p in parts) / count, _FINEST**2)
        normal = np.sum([p.normal for p in parts], axis=0) / noise + np.diag(expected)
        pull = np.sum([p.gradient for p in parts], axis=0) / noise
        pull[CAMERA:] -= expected[CAMERA:] * shape
        step, covariance = np.zeros(len(free)), np.zeros(normal.shape)
        inverse = _inverse(normal[np.ix_(free, free)])
        covariance[np.ix_(free, free)] = inverse
        if not np.all(np.isfinite(inverse)):
            break
        step[free] = inverse @ pull[free]
        if np.abs(step[:2]).max() > _FARTHEST * camera[:2].min():
            covariance[:] = np.nan
            break
        camera, shape = camera + step[:CAMERA], shape + step[CAMERA:]
        poses = [p + q.place_step - q.place_coupling @ step for p, q in zip(poses, parts, strict=True)]
        if np.abs(step[free] / np.sqrt(np.diag(inverse))).max() < _DONE:
            break
    widened, scatter = _widened(parts, normal, covariance, free, noise)
    return Bundle(
        camera=camera,
        covariance=widened[:CAMERA, :CAMERA],
        shape=shape,
        shape_covariance=widened[CAMERA:, CAMERA:],
        error=float(np.sqrt(sum(p.squares for p in parts) / sum(len(s) for s in seen))),
        scatter=scatter,
    )


def _linearise(
    model: ShapeModel, corners: FloatArray, camera: FloatArray, shape: FloatArray, pose: FloatArray
) -> _Picture:
    k = np.array([[camera[0], 0.0, camera[2]], [0.0, camera[1], camera[3]], [0.0, 0.0, 1.0]])
    turn, place = pose[:3], pose[3:]
    again, jacobian = cv2.projectPoints(model.bent(shape), turn, place, k, camera[4:])
    miss = (corners - again[:, 0]).ravel()
    by_pose, by_place = jacobian[:, :6], jacobian[:, 3:6].reshape(-1, 2, 3)
    rotation = cv2.Rodrigues(turn)[0]
    by_shape = np.einsum("nij,mnj->nim", by_place @ rotation, model.by_parameter).reshape(len(miss), -1)
    by_all = np.hstack([jacobian[:, 6 : 6 + CAMERA], by_shape])
    solved = np.linalg.lstsq(by_pose, np.column_stack([miss, by_all]), rcond=None)[0]
    rest = by_all - by_pose @ solved[:, 1:]
    return _Picture(rest.T @ rest, rest.T @ miss, float(miss @ miss), solved[:, 0], solved[:, 1:])


def _inverse(normal: FloatArray) -> FloatArray:
    """Of normal equations; nan when they leave a parameter open."""
    size = np.diag(normal)
    if not np.all(size > _NOTHING):
        return np.full(normal.shape, np.nan)
    scale = 1.0 / np.sqrt(size)
    values, vectors = np.linalg.eigh(normal * np.outer(scale, scale))
    if values[0] < _OPEN * values[-1]:
        return np.full(normal.shape, np.nan)
    inverse: FloatArray = (vectors / values) @ vectors.T * np.outer(scale, scale)
    return inverse


def _widened(
    parts: list[_Picture], normal: FloatArray, covariance: FloatArray, free: BoolArray, noise: float
) -> tuple[FloatArray, float]:
    """The covariance, each parameter with the larger of its deviations: by noise and by leaving out pictures.

    Leaving out picture i moves the result by (N - N_i)^-1 g_i; n - 1 over n of the sum of squares is the jackknife's
    variance (Efron, "The jackknife, the bootstrap and other resampling plans", 1982).
    """
    if not np.all(np.isfinite(covariance)):
        return covariance, float("nan")
    inside = np.ix_(free, free)
    moved = []
    for part in parts:
        inverse = _inverse(normal[inside] - part.normal[inside] / noise)
        if np.all(np.isfinite(inverse)):
            moved.append(inverse @ part.gradient[free] / noise)
    variance = (len(moved) - 1) / max(len(moved), 1) * np.sum(np.square(moved), axis=0)
    share = np.ones(len(free))
    share[free] = np.sqrt(variance / np.diag(covariance)[free])
    factor = np.maximum(share, 1.0)
    return covariance * np.outer(factor, factor), float(share[free].max())
