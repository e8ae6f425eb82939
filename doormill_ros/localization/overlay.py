"""Draws what was found into the picture, for people."""

from __future__ import annotations

import textwrap

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray, IntArray
from doormill_ros.errors import DoormillError
from doormill_ros.localization.result import Localization
from doormill_ros.units import m_to_mm, rad_to_deg

_GREEN, _RED, _YELLOW, _WHITE = (70, 230, 90), (255, 50, 40), (255, 200, 30), (255, 255, 255)
_BITS = 4  # fractional bits of a pixel that the drawing routines keep
_EVERY = 10  # of the points that agree, one in so many is drawn
_ENLARGED = 20  # the ellipse of uncertainty is drawn that much too large
_SIGMAS = 2.0
_LINE = 44  # characters that fit on the panel


def _fixed(pixels: FloatArray) -> IntArray:
    fixed: IntArray = np.rint(np.asarray(pixels) * 2**_BITS).astype(np.int32)
    return fixed


def _write(out: ByteArray, lines: list[str]) -> None:
    """Text on a darkened panel in the upper left corner."""
    pitch, width = 36, 760
    panel = out[20 : 40 + pitch * len(lines), 20:width]
    panel[:] = panel // 4
    for i, text in enumerate(lines):
        cv2.putText(out, text, (36, 58 + pitch * i), cv2.FONT_HERSHEY_SIMPLEX, 0.9, _WHITE, 1, cv2.LINE_AA)


def _ellipse(localization: Localization) -> FloatArray:
    """Outline of the corner's uncertainty, enlarged; pixels (60, 2). Picture u is -y, v is -z."""
    values, axes = np.linalg.eigh(localization.covariance[:2, :2])
    angle = np.linspace(0, 2 * np.pi, 60)
    circle = np.stack([np.cos(angle), np.sin(angle)]) * np.sqrt(np.maximum(values, 0))[:, None]
    outline: FloatArray = localization.corner - (axes @ circle).T * (_SIGMAS * _ENLARGED / localization.pixel)
    return outline


def draw_overlay(picture: ByteArray, localization: Localization) -> ByteArray:
    """The picture with edge points, lines, pose and uncertainty.

    Points that agree with their line are green rings, the others red; the lines are yellow; the
    ellipse about the corner is its uncertainty, enlarged.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        localization: What was found in it.

    Returns:
        The drawn picture, rgb, uint8, shape (h, w, 3).
    """
    out: ByteArray = cv2.cvtColor(picture, cv2.COLOR_GRAY2RGB)
    for edge in localization.edges:
        for colour, chosen, every in ((_GREEN, edge.inlier, _EVERY), (_RED, ~edge.inlier, 2)):
            for point in _fixed(edge.pixels[chosen][::every]):
                cv2.circle(out, point.tolist(), 4 << _BITS, colour, 1, cv2.LINE_AA, _BITS)
        cv2.polylines(out, [_fixed(edge.line).reshape(-1, 1, 2)], False, _YELLOW, 1, cv2.LINE_AA, _BITS)
    ring = _fixed(_ellipse(localization)).reshape(-1, 1, 2)
    cv2.polylines(out, [ring], True, _WHITE, 2, cv2.LINE_AA, _BITS)
    cv2.drawMarker(
        out, np.rint(localization.corner).astype(int).tolist(), _WHITE, cv2.MARKER_CROSS, 30, 2, cv2.LINE_AA
    )
    offset, deviation = localization.offset, localization.deviations
    lines = [
        f"y {m_to_mm(offset.y):+8.3f} mm   +- {m_to_mm(deviation[0]):.3f}",
        f"z {m_to_mm(offset.z):+8.3f} mm   +- {m_to_mm(deviation[1]):.3f}",
        f"rotation {rad_to_deg(offset.rotation):+7.3f} deg   +- {rad_to_deg(deviation[2]):.3f}",
        f"residual {m_to_mm(localization.residual):.3f} mm, inliers {100 * localization.inlier_share:.0f} %, "
        f"quality {localization.quality:.2f}",
    ]
    for edge in localization.edges:
        lines.append(f"{edge.name} edge: step {edge.contrast:+.0f} grey levels, blur {edge.blur:.1f} px")
    lines.append(f"ellipse: {_SIGMAS:.0f} sigma x {_ENLARGED}")
    _write(out, lines)
    return out


def draw_refusal(picture: ByteArray, reason: DoormillError) -> ByteArray:
    """The picture with the sentence of its refusal and the places that it speaks of.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        reason: Why there is no pose; `data["marks"]` holds pairs of a name and pixels u, v (n, 2).

    Returns:
        The drawn picture, rgb, uint8, shape (h, w, 3).
    """
    out: ByteArray = cv2.cvtColor(picture, cv2.COLOR_GRAY2RGB)
    for i, (name, pixels) in enumerate(reason.data.get("marks", ())):
        colour = (_RED, _YELLOW)[i % 2]
        cv2.polylines(out, [_fixed(pixels).reshape(-1, 1, 2)], False, colour, 2, cv2.LINE_AA, _BITS)
        u, v = (int(at) for at in np.mean(pixels, axis=0))
        cv2.putText(
            out, name, (u + 12, v + 12 + 36 * i), cv2.FONT_HERSHEY_SIMPLEX, 0.9, colour, 2, cv2.LINE_AA
        )
    _write(out, textwrap.wrap(f"{reason.code}: {reason.message}", _LINE))
    return out
