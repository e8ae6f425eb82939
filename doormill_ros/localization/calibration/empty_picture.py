"""A picture of the empty clamp, made of one or a few, or why they are of no use for that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray, Float32Array
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.localization import checks
from doormill_ros.localization.calibration.errors import BadCalibrationFile, DoorInClamp, TooFewPictures
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.edge_points.profiles import WHITE
from doormill_ros.localization.errors import LocalizationError, OverExposed
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.marks.drift import drift_in
from doormill_ros.localization.rims.processing import check_levels, level_counts
from doormill_ros.statistics import median, share
from doormill_ros.units import m_to_mm

NOISIEST = 4.0  #: grey levels, of one pixel of the averaged picture
MOST_WHITE = 0.05  #: share of the picture that may be clipped; there it tells nothing
#: Of the doors that are looked for in it [m]: a corner that looks like one shows at about its distance.
_THICKNESSES = (0.03, 0.04, 0.05, 0.07, 0.1)
_BLOCK = 16  # px, side of the blocks that are compared
_APART = 0.15  # share of the brightness by which a block may differ between two pictures
_DARK = 8.0  # grey levels below which that is taken of this brightness
_EDGE = 5.0  # medians beyond which what differs from its neighbours is no noise


@dataclass(frozen=True, eq=False)
class EmptyPicture:
    """The mean of pictures of the empty clamp.

    Attributes:
        picture: Grey picture, shape (h, w), uint8.
        noise: Standard deviation of one of its pixels [grey levels].
        count: Pictures that it is the mean of.
    """

    picture: ByteArray
    noise: float
    count: int


def empty_picture(
    pictures: Sequence[ByteArray], camera: CameraModel, layout: CellLayout, width: float, sure: bool = False
) -> EmptyPicture:
    """Average pictures of the empty clamp.

    Args:
        pictures: Grey pictures, shape (h, w), uint8.
        camera: The calibrated camera.
        layout: Where the nominal door stands.
        width: Door width for which the slider stands [m].
        sure: Whether somebody has seen to it that no door stands there, whatever looks like one.

    Raises:
        TooFewPictures: There is none.
        LocalizationError: One is of another size than the camera's, too bright, too dark or processed, or the camera's
            marks have moved: the leaf for it.
        BadCalibrationFile: The width is that of no door, the pictures differ, or they are too noisy.
        DoorInClamp: A door seems to stand there.
    """
    if not pictures:
        raise TooFewPictures("no picture of the empty clamp was given, one is needed, better five; take them")
    low, high = checks.WIDTHS
    if not low <= width <= high:
        raise BadCalibrationFile(
            f"the slider is said to stand for a door of {m_to_mm(width):g} mm, allowed are {m_to_mm(low):g} to "
            f"{m_to_mm(high):g} mm; give --width MM of the doors that are to be compared with these pictures"
        )
    nominal = layout.T_base_door(width, _THICKNESSES[1])[:3, 3]
    for picture in pictures:
        checks.check_size(picture.shape[::-1], camera)
        counts = level_counts(picture)
        checks.check_exposure(counts)
        _check_white(picture)
        check_levels(counts)
        drift_in(picture, camera, width, nominal)
    total = np.zeros(pictures[0].shape, dtype=np.float32)
    for picture in pictures:
        total += picture
    mean = total / np.float32(len(pictures))
    _check_alike(pictures, mean)
    averaged: ByteArray = np.rint(mean).astype(np.uint8)
    noise = _noise(pictures[0]) / np.sqrt(len(pictures))
    if noise > NOISIEST:
        need = int(np.ceil(len(pictures) * (noise / NOISIEST) ** 2))
        raise BadCalibrationFile(
            f"the mean of {len(pictures)} pictures of the empty clamp has a noise of {noise:.1f} grey levels, allowed "
            f"are {NOISIEST:g}; give {need} pictures, or more light and less gain"
        )
    if not sure:
        _check_no_door(averaged, replace(camera, empty=(), marks=None), layout, width)
    return EmptyPicture(averaged, float(noise), len(pictures))


def _check_white(picture: ByteArray) -> None:
    white = share(picture[::4, ::4] >= WHITE)
    if white > MOST_WHITE:
        raise OverExposed(
            f"{100 * white:.0f} % of the picture of the empty clamp are clipped at white, allowed are "
            f"{100 * MOST_WHITE:.0f} %; shorten the exposure or dim the light",
            share=white,
        )


def _noise(picture: ByteArray) -> float:
    """Standard deviation of a pixel (h, w), by what differs from both neighbours: edges are few [grey levels]."""
    rows = picture[::7].astype(np.float32)
    bend = np.abs(rows[:, 2:] - 2.0 * rows[:, 1:-1] + rows[:, :-2])
    # Grey levels are whole numbers, so the median is too: it only says what is an edge.
    most = _EDGE * max(median(bend), 1.0)
    return float(np.sqrt(np.mean(np.minimum(bend, most) ** 2) / 6.0))


def _check_alike(pictures: Sequence[ByteArray], mean: Float32Array) -> None:
    """Whether nothing was moved while they were taken; all as bright as their mean, blocks (h / 16, w / 16)."""
    height, width = mean.shape
    size = max(width // _BLOCK, 1), max(height // _BLOCK, 1)
    usual = cv2.resize(mean, size, interpolation=cv2.INTER_AREA)
    for i, picture in enumerate(pictures):
        blocks = cv2.resize(picture, size, interpolation=cv2.INTER_AREA).astype(np.float32)
        blocks *= np.float32(usual.sum() / max(float(blocks.sum()), 1.0))
        apart = np.abs(blocks - usual) / cv2.max(usual, _DARK)
        if float(apart.max()) > _APART:
            v, u = (int((at + 0.5) * _BLOCK) for at in np.unravel_index(int(np.argmax(apart)), apart.shape))
            raise BadCalibrationFile(
                f"picture {i + 1} of the empty clamp differs from their mean by {100 * float(apart.max()):.0f} % about "
                f"u = {u}, v = {v} px, allowed are {100 * _APART:.0f} %: something was moved; take them again"
            )


def _check_no_door(picture: ByteArray, camera: CameraModel, layout: CellLayout, width: float) -> None:
    for thickness in _THICKNESSES:
        try:
            found = localize(picture, camera, layout, width, thickness)
        except LocalizationError:
            continue
        u, v = found.corner
        raise DoorInClamp(
            f"what looks like the corner of a door stands at u = {u:.0f}, v = {v:.0f} px in the picture of the empty "
            "clamp; take the door out, or give --sure when the clamp is empty and this is a plate or jaw of its own",
            corner=found.corner,
        )
