"""Whether the picture of the empty clamp still is what the camera sees beside a door."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np

from doormill_ros.arrays import BoolArray, ByteArray, FloatArray
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.empty_clamp.background import BackgroundFit, PictureShift, fit_background
from doormill_ros.localization.empty_clamp.empty_clamp import EmptyClamp
from doormill_ros.localization.empty_clamp.picture_pattern import (
    CLEAR,
    TILE,
    PicturePattern,
    covered,
    pattern_of,
)
from doormill_ros.localization.empty_clamp.quartered import DOWN
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView
from doormill_ros.units import m_to_mm

MOVED = 0.5  #: of the background, beyond which the picture is told to be stale [px]
SIGMAS = 3.0  #: standard deviations by which it has to be beyond
LOST = 0.5  #: share of the structure that is no longer there
FEWEST = 12  #: tiles that are needed to say that it is not, or that the light is another one
BRIGHTER = 1.6  #: factor on the light nearly everywhere that no ageing makes
DARKER = 4.0  #: the same of less light, which shadows make together with ageing
# Of a door's outline: how far it goes on outside the picture, and between its points [m].
_BEYOND, _STEP = 0.02, 0.005
_SAME = 0.1  # px between pixels of two cameras that are one


@dataclass(frozen=True, eq=False)
class ClampFit:
    """What the background of a picture says of the picture of the empty clamp.

    Attributes:
        clamp: The empty clamp.
        background: How the picture's background lies upon it.
    """

    clamp: EmptyClamp
    background: BackgroundFit

    @property
    def moved(self) -> bool:
        """Whether the background surely lies elsewhere."""
        return self.background.moved - SIGMAS * self.background.deviation > MOVED

    @property
    def changed(self) -> bool:
        """Whether most of what the empty clamp shows is no longer there."""
        return self.background.judged >= FEWEST and self.background.lost > LOST

    @property
    def relit(self) -> bool:
        """Whether there is another light nearly everywhere."""
        low, _, high = self.background.light
        return bool(self.background.tiles >= FEWEST and (low > BRIGHTER or high < 1.0 / DARKER))

    @property
    def stale(self) -> bool:
        """Whether the picture of the empty clamp is to be taken again."""
        return self.moved or self.changed or self.relit

    @property
    def displacement(self) -> PictureShift | None:
        """From a place in the picture to that in the empty clamp, where it is another one and known."""
        return self.background.displacement if self.moved and not self.changed else None

    @property
    def sentence(self) -> str:
        """What no longer fits and what to do."""
        said = []
        if self.changed:
            said.append(
                f"{100 * self.background.lost:.0f} % of what it shows beside the door is no longer there"
            )
        elif self.moved:
            said.append(f"the background lies {self.background.moved:.1f} px from where it was")
        if self.relit:
            said.append(f"the background is {self.background.light[1]:.2g} times as bright as it was")
        when = f", taken {self.clamp.taken}," if self.clamp.taken else ""
        return (
            f"the picture of the empty clamp for doors of {m_to_mm(self.clamp.width):g} mm{when} no longer fits: "
            f"{' and '.join(said)}; take it again with calibrate empty"
        )


@lru_cache(maxsize=4)  # large, and wanted of the width in hand
def clamp_pattern(clamp: EmptyClamp) -> PicturePattern:
    """The pattern of the picture of an empty clamp."""
    return pattern_of(clamp.picture).worked_out()


def fit_clamp(
    picture: ByteArray, camera: CameraModel, clamp: EmptyClamp, seen: FaceView, pose: FloatArray
) -> ClampFit | None:
    """Compare what a picture shows beside a door with the empty clamp.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        camera: Its camera.
        clamp: The empty clamp.
        seen: The camera that took it before the door's face.
        pose: y, z [m] and rotation [rad] of the door, shape (3,).

    Returns:
        What was found; None where no background is seen.
    """
    theirs = clamp_pattern(clamp)
    free = ~covered(_outline(seen, pose), theirs.relative.shape)
    window = _window(camera, clamp)
    if window is not None:
        height, width = clamp.picture.shape
        free &= _inside(window, camera.size, free.shape)
        picture = np.asarray(cv2.warpAffine(picture, window, (width, height)), dtype=np.uint8)
    fit = fit_background(pattern_of(picture), theirs, free)
    return None if fit is None else ClampFit(clamp, fit)


def _outline(view: FaceView, pose: FloatArray) -> FloatArray:
    """Pixels u, v (n, 2) round the part of a door at `pose` (3,) that may be in the picture."""
    hinge, bottom = (
        view.pixels(view.line(edge, pose, np.arange(0.0, view.length(edge) + _BEYOND, _STEP)))
        for edge in (HINGE, BOTTOM)
    )
    return np.concatenate([hinge[::-1], bottom, [[bottom[-1, 0], hinge[-1, 1]]]])


def _window(camera: CameraModel, clamp: EmptyClamp) -> FloatArray | None:
    """From pixels of a part of the sensor to those of all of it, shape (2, 3); None where they are the same."""
    to_whole: FloatArray = (clamp.k @ np.linalg.inv(camera.k))[:2]
    width, height = camera.size
    corners = np.array([[0.0, 0.0, 1.0], [width, height, 1.0]])
    same = np.abs(corners @ to_whole.T - corners[:, :2]).max() < _SAME
    return None if same and camera.size == clamp.picture.shape[::-1] else to_whole


def _inside(window: FloatArray, size: tuple[int, int], shape: tuple[int, int]) -> BoolArray:
    """Which tiles (rows, columns) are in a part of the sensor of that width and height, clear of its border."""
    (left, top), (right, low) = (window @ [u, v, 1.0] for u, v in ((-0.5, -0.5), np.subtract(size, 0.5)))
    side, clear = TILE * DOWN, CLEAR * DOWN
    rows, columns = (side * np.arange(number) for number in shape)
    inside: BoolArray = ((rows >= top + clear) & (rows + side <= low - clear))[:, None] & (
        (columns >= left + clear) & (columns + side <= right - clear)
    )
    return inside
