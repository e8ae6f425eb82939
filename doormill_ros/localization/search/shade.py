"""Surfaces beside a line, read in the picture, and whether the line is the border of a shadow that falls on them."""

from __future__ import annotations

from dataclasses import dataclass
from math import log

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.view import HINGE, FaceView
from doormill_ros.statistics import median

PITCH = 0.1e-3  #: between places that are read along an edge [m]
WELL = (10.0e-3, 40.0e-3)  #: where the brightness of a surface is read, from the corner [m]
BESIDE = (0.6e-3, 1.6e-3)  #: where surfaces beside a line are read, from it [m]
_SHADE = 0.35  # a shadow darkens face and background alike, to that share of the logarithm
_CLOSELY, _SURELY = (0.3e-3, 0.8e-3), 0.15  # the same two, for what may be a shadow or else a tool


@dataclass(frozen=True, eq=False)
class Surfaces:
    """Brightness of the face and of what lies beside it, in a picture of shape (h, w)."""

    picture: ByteArray
    view: FaceView

    def along(self, edge: str, across: FloatArray, tilt: float, along: FloatArray) -> FloatArray:
        """Mean grey level (n,) at distances `along` (n,) of an edge, over parallels at `across` (k,)."""
        grey = self.rows(edge, across, tilt, along)
        mean: FloatArray = grey.sum(axis=0, dtype=float) / len(grey)
        return mean

    def level(self, edge: str, across: FloatArray, tilt: float, start: float, stop: float) -> float:
        """Median grey level along an edge between two distances [m], over parallels at `across` (k,)."""
        return self.levels(edge, [across], [tilt], start, stop)[0]

    def levels(
        self, edge: str, across: list[FloatArray], tilts: list[float], start: float, stop: float
    ) -> list[float]:
        """The `level` of several surfaces, each over its parallels at `across` (k,) of its own tilt; read at once."""
        tilt = np.repeat(tilts, [one.size for one in across])[:, None]
        grey = self.rows(edge, np.concatenate(across), tilt, np.arange(start, stop, 4 * PITCH))
        out, first = [], 0
        for one in across:
            rows = grey[first : first + one.size]
            out.append(median(rows.sum(axis=0, dtype=float) / one.size))
            first += one.size
        return out

    def rows(self, edge: str, across: FloatArray, tilt: FloatArray | float, along: FloatArray) -> ByteArray:
        """Grey levels (k, n) at distances `along` (n,) of an edge, on parallels at `across` (k,)."""
        places = np.empty((2, across.size, along.size))
        run, cross = (1, 0) if edge == HINGE else (0, 1)
        places[run] = along
        np.add(across[:, None], tilt * along, out=places[cross])
        u, v = self.view.planes(places.reshape(2, -1)).astype(np.float32).reshape(places.shape)
        grey = cv2.remap(self.picture, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(grey, dtype=np.uint8)


def shaded(
    sight: Surfaces,
    edge: str,
    line: EdgeLine,
    corner: float,
    end: float,
    beside: tuple[float, float] = BESIDE,
    shade: float = _SHADE,
) -> bool:
    """Whether a line darkens face and background alike where it goes on beyond the corner."""
    outer, inner = (line.across + sign * np.linspace(*beside, 4) for sign in (-1.0, 1.0))
    ratios = []
    for start, stop in ((corner + 4.0e-3, corner + WELL[1]), (end - 8.0e-3, end - 1.5e-3)):
        levels = sight.levels(edge, [outer, inner], [line.tilt, line.tilt], start, stop)
        if min(levels) < 2.0:
            return False
        ratios.append(log(levels[0] / levels[1]))
    face, background = ratios
    return abs(face) > 0.1 and face * background > 0 and abs(background - face) < shade * abs(face)


def is_shadow(
    picture: ByteArray, view: FaceView, edge: str, line: EdgeLine, corner: FloatArray, end: float
) -> bool:
    """Whether a line is surely the border of a shadow that falls on the face and on what lies behind it.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        edge: "hinge" or "bottom".
        line: The line.
        corner: Where it meets the other edge, y and z, shape (2,) [m].
        end: Where the face ends along it [m].
    """
    place = float(corner[1 if edge == HINGE else 0])
    return shaded(Surfaces(picture, view), edge, line, place, end, _CLOSELY, _SURELY)
