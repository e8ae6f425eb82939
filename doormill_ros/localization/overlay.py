"""Draws what was found into the picture, for people."""

from __future__ import annotations

import cv2
import numpy as np

from doormill_ros.localization.result import Localization
from doormill_ros.units import m_to_mm, rad_to_deg

_GREEN, _RED, _YELLOW, _WHITE = (80, 220, 80), (235, 60, 50), (255, 210, 40), (255, 255, 255)
_FRACTION = 4  # bits of a pixel that the drawing routines keep


def draw_overlay(picture: np.ndarray, localization: Localization) -> np.ndarray:
    """The picture (h, w) uint8 with edge points, lines and the pose; rgb, uint8, shape (h, w, 3).

    Points that agree with their line are green, the others red; the lines are yellow.
    """
    out = cv2.cvtColor(picture, cv2.COLOR_GRAY2RGB)
    for edge in localization.edges:
        fixed = np.rint(edge.line * 2**_FRACTION).astype(np.int32)
        cv2.polylines(out, [fixed.reshape(-1, 1, 2)], False, _YELLOW, 1, cv2.LINE_AA, _FRACTION)
        for colour, chosen in ((_RED, ~edge.inlier), (_GREEN, edge.inlier)):
            for point in np.rint(edge.pixels[chosen][:: 1 if colour is _RED else 8] * 2**_FRACTION):
                cv2.circle(out, [int(v) for v in point], 3 << _FRACTION, colour, 1, cv2.LINE_AA, _FRACTION)
    corner = [int(v) for v in np.rint(localization.corner)]
    cv2.drawMarker(out, corner, _WHITE, cv2.MARKER_CROSS, 40, 2, cv2.LINE_AA)
    offset, deviation = localization.offset, localization.deviations
    lines = [
        f"y {m_to_mm(offset.y):+8.3f} mm   +- {m_to_mm(deviation[0]):.3f}",
        f"z {m_to_mm(offset.z):+8.3f} mm   +- {m_to_mm(deviation[1]):.3f}",
        f"r {rad_to_deg(offset.rotation):+8.4f} deg  +- {rad_to_deg(deviation[2]):.4f}",
        f"residual {m_to_mm(localization.residual):.3f} mm, inliers {100 * localization.inlier_share:.0f} %",
    ]
    for i, text in enumerate(lines):
        place = (30, 45 + 34 * i)
        cv2.putText(out, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.9, (0, 0, 0), 4, cv2.LINE_AA)
        cv2.putText(out, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.9, _WHITE, 1, cv2.LINE_AA)
    return out
