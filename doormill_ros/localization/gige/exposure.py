"""Exposure by the light at the door's edges: the brightest there is bright, and none of it is clipped."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray
from doormill_ros.cell.places.layout import PlacementLimits
from doormill_ros.localization.gige.device import Limits
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView

TARGET = 170.0  #: grey level that the light at the edges is brought to,
ENOUGH = Limits(110.0, 220.0)  #: and within which it is left as it is
CLIPPED = 250.0  #: grey level from which on nothing tells how much light there was
SHORTER = 0.25  #: factor on the exposure of a clipped picture
FURTHEST = 16.0  #: largest factor from one picture to the next; dark ones are mostly noise
ROUNDS = 8  #: pictures until the exposure is right
#: Wood is brighter than the background or darker; that share of the pixels beside the edges is darker than its level.
#: A door at the limit of its placement still covers more than the rest of them.
BRIGHT = 0.9
_MARGIN = 5e-3  # beside the largest displacement of an edge [m]
_STEP = 4  # every so many rows and columns are looked at


class EdgeLight:
    """Measures the light where a door's edges may lie."""

    def __init__(self, view: FaceView, limits: PlacementLimits) -> None:
        """Of the door that `view` shows, placed within `limits`."""
        width, height = view.camera.size
        mask = np.zeros((height, width), dtype=np.uint8)
        for edge in (HINGE, BOTTOM):
            length = view.length(edge)
            reach = max(limits.y, limits.z) + limits.rotation * length + _MARGIN
            across, along = np.array([-reach, reach, reach, -reach]), np.array([0.0, 0.0, length, length])
            points = np.stack([across, along] if edge == HINGE else [along, across], axis=-1)
            cv2.fillPoly(mask, [np.round(view.pixels(points)).astype(np.int32)], 1)
        self._looked_at = mask[::_STEP, ::_STEP] > 0

    def level(self, picture: ByteArray) -> float:
        """Grey level of the bright side of the edges in a picture, shape (height, width)."""
        pixels = picture[::_STEP, ::_STEP][self._looked_at]
        return float(np.quantile(pixels if pixels.size else picture, BRIGHT))


def better(level: float, exposure: float, limits: Limits) -> float:
    """The exposure [s] within `limits` with which the edges come out at TARGET; the given one where it will do.

    Sensors are linear: light is grey level over exposure, unless it was clipped.
    """
    if ENOUGH.low <= level <= ENOUGH.high:
        return exposure
    factor = SHORTER if level >= CLIPPED else min(TARGET / max(level, 1.0), FURTHEST)
    return min(max(exposure * factor, limits.low), limits.high)


class Exposed(NamedTuple):
    """A picture, shape (height, width), how long it was exposed [s], and the light at the edges in it [grey level]."""

    picture: ByteArray
    exposure: float
    level: float


def exposed(take: Callable[[float], ByteArray], light: EdgeLight, exposure: float, limits: Limits) -> Exposed:
    """Take pictures until the light at the edges is right, or as near to it as `limits` [s] let it come.

    Args:
        take: Takes a picture, shape (height, width), with an exposure [s].
        light: Of the door that stands there.
        exposure: To begin with [s].
        limits: Shortest and longest exposure [s].
    """
    for _ in range(ROUNDS):
        exposure = min(max(exposure, limits.low), limits.high)
        picture = take(exposure)
        level = light.level(picture)
        next_one = better(level, exposure, limits)
        if next_one == exposure:
            break
        exposure, used = next_one, exposure
    else:
        exposure = used
    return Exposed(picture, exposure, level)
