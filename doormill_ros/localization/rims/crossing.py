"""A rim round the corner that is as dark as the background: along the edges nothing tells it from that.

Both edges are then read at its inner border. Where the rims of the two edges cross, outside of the corner that they
make, the face is darkened twice and darker than the background: a spot as large as the rim is wide. It is looked for in
what the corner of two steps leaves, beside small displacements of the two edges there.
"""

from __future__ import annotations

from math import sqrt

import cv2
import numpy as np
from scipy.linalg.lapack import dposv

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization.edge_points.step_models import blurred_step
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.view import FaceView
from doormill_ros.units import m_to_mm

_PITCH = 0.5  # of what is read about the corner [px]
_REACH = (-9.0, 5.0)  # from outside of it to inside [px]
_WIDTHS = np.array([1.2, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0])  # of rims that are looked for [px]
_GREY = 1.5  # standard deviation of a grey level by noise and texture
_WANDER = 0.15  # and of an edge, which counts by the slope there [px]
_CLEAR = 4.0  # standard deviations from which a spot is one; of pictures without a rim none had 2.2
_DARK = (0.15, 2.5)  # least and most of it, as a share of what a rim as dark as the background leaves

_ACROSS = np.arange(_REACH[0], _REACH[1], _PITCH)
_U, _V = np.meshgrid(_ACROSS, _ACROSS, indexing="ij")


def check_crossing(picture: ByteArray, view: FaceView, pose: FloatArray, blur: float) -> None:
    """Whether no rim crosses itself outside of the corner; asked where either edge looks like one step.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        pose: y, z [m] and rotation [rad] of the corner, shape (3,).
        blur: Standard deviation of the point spread [px].

    Raises:
        WrongEdge: One does.
    """
    width, spot, deviation, whole = _darkest(_read(picture, view, pose), blur)
    if spot > -_CLEAR * deviation or not _DARK[0] < spot / min(whole, -1e-9) < _DARK[1]:
        return
    turn = np.array([[np.cos(pose[2]), -np.sin(pose[2])], [np.sin(pose[2]), np.cos(pose[2])]])
    square = np.array([[0.0, 0.0], [-1.0, 0.0], [-1.0, -1.0], [0.0, -1.0], [0.0, 0.0]]) * width * view.pixel
    raise WrongEdge(
        f"outside of the corner lies a spot {m_to_mm(width * view.pixel):.2f} mm wide and {-spot:.0f} grey levels "
        "darker than the background, as a rim leaves where it crosses itself: along the edges it is as dark as the "
        "background, and where it ends is not seen; or the spot is on what stands behind; clean the arris, or put "
        "another background behind the door",
        edge="bottom",
        marks=(("crossing", view.pixels(pose[:2] + square @ turn.T)),),
    )


def _read(picture: ByteArray, view: FaceView, pose: FloatArray) -> FloatArray:
    """Grey levels about the corner, along both edges and across them, shape (n, n)."""
    u, v = _U * view.pixel, _V * view.pixel
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    places = np.stack([pose[0] + cos * u - sin * v, pose[1] + sin * u + cos * v])
    at = view.planes(places.reshape(2, -1)).astype(np.float32).reshape(places.shape)
    grey = cv2.remap(picture, at[0], at[1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(grey, dtype=float)


def _darkest(grey: FloatArray, blur: float) -> tuple[float, float, float, float]:
    """Width [px] of the spot that fits best, its height, its standard deviation and what it should be [grey levels]."""
    step = blurred_step(_ACROSS, blur)
    slope = np.gradient(step, _PITCH)
    face = np.outer(step, step)
    by_hinge, by_bottom = np.outer(slope, step), np.outer(step, slope)
    contrast = float(np.ptp(grey))
    weight = 1.0 / np.sqrt(_GREY**2 + (_WANDER * contrast) ** 2 * (by_hinge**2 + by_bottom**2))
    corner = (np.stack([face, 1.0 - face, by_hinge, by_bottom]) * weight).reshape(4, -1)
    outside = blurred_step(_ACROSS + _WIDTHS[:, None], blur) - step
    seen = np.empty((1 + len(_WIDTHS), *grey.shape))  # the picture, and the spots
    seen[0] = grey
    np.multiply(outside[:, :, None], outside[:, None, :], out=seen[1:])
    seen *= weight
    left_over = seen.reshape(len(seen), -1)
    _, explained, _ = dposv(corner.dot(corner.T), corner.dot(left_over.T))
    left_over -= explained.T.dot(corner)
    rest, spots = left_over[0], left_over[1:]
    squares = np.einsum("wn,wn->w", spots, spots)
    heights = spots.dot(rest) / squares
    left = float(rest.dot(rest)) - heights**2 * squares
    best = int(np.argmin(left))
    # Two looks a pixel either way: a quarter of them tell something of their own.
    noise = max(1.0, float(left[best]) / (grey.size - 4 / _PITCH**2))
    deviation = sqrt(noise / (float(squares[best]) * _PITCH**2))
    bright, back = float(explained[0, 0]), float(explained[1, 0])
    whole = back * (back / max(bright, 1.0) - 1.0)
    return float(_WIDTHS[best]), float(heights[best]), deviation, whole
