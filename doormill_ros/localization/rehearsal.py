"""A door drawn with two strokes, and found: what happens at first use is over when the first picture comes."""

from __future__ import annotations

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray
from doormill_ros.cell.layout import CellLayout
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.result import Localization
from doormill_ros.localization.view import BOTTOM, HINGE, face_view

WIDTH, THICKNESS = 0.9, 0.04  # m
DARK, BRIGHT, NOISE = 40, 170, 2.0  # grey, of background and wood, and its standard deviation
BLUR = 1.0  # px
BEYOND, STEP = (
    0.02,
    0.005,
)  # m; the face goes on outside the picture, and is drawn in such steps: lenses bend lines
SHIFT = 4  # bits behind the point of a drawn corner's pixel


def rehearse(camera: CameraModel, layout: CellLayout) -> tuple[Localization, ByteArray]:
    """Find a bright face before a dark background where the nominal door stands.

    Returns:
        What was found, and the picture, shape (h, w), uint8.

    Raises:
        LocalizationError: This camera or layout shows no door there.
    """
    picture = _drawn(camera, layout)
    return localize(picture, camera, layout, WIDTH, THICKNESS), picture


def _drawn(camera: CameraModel, layout: CellLayout) -> ByteArray:
    view = face_view(camera, layout, WIDTH, THICKNESS)
    hinge, bottom = (
        view.pixels(view.line(edge, np.zeros(3), np.arange(0.0, view.length(edge) + BEYOND, STEP)))
        for edge in (HINGE, BOTTOM)
    )
    far = np.array([[bottom[-1, 0], hinge[-1, 1]]])
    outline = np.concatenate([hinge[::-1], bottom, far])
    width, height = camera.size
    face = np.full((height, width), float(DARK), dtype=np.float32)
    cv2.fillPoly(face, [np.round(outline * 2**SHIFT).astype(np.int32)], float(BRIGHT), shift=SHIFT)
    face = cv2.GaussianBlur(face, (0, 0), BLUR)
    face += np.random.default_rng(0).normal(0.0, NOISE, face.shape)
    picture: ByteArray = face.clip(0.0, 255.0).astype(np.uint8)
    return picture
