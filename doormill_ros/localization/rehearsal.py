"""A door drawn with two strokes, to be found before the first picture comes: what happens at first use is over then."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.view import BOTTOM, HINGE, face_view

DARK, BRIGHT, NOISE = 40, 170, 2.0  # grey, of background and wood, and its standard deviation
BLUR = 1.0  # px
BEYOND = 0.02  # m that the face goes on outside the picture
STEP = 0.005  # m between the corners with which it is drawn: lenses bend lines
SHIFT = 4  # bits behind the point of a drawn corner's pixel


@dataclass
class DrawnFace:
    """Size of the drawn door [m]."""

    width: float = 0.9
    thickness: float = 0.04


FACE = DrawnFace()


def drawn_door(camera: CameraModel, layout: CellLayout) -> ByteArray:
    """A picture, shape (h, w), uint8, of a bright `FACE` before a dark background where the nominal door stands."""
    view = face_view(camera, layout, FACE.width, FACE.thickness)
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
