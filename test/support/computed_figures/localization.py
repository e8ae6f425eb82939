"""What docs/localization.md prints: where the camera looks, and what a pixel is."""

from __future__ import annotations

import numpy as np

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.lens_apart import SAME
from support.page_figures import number_of
from support.pictures.conditions import CONDITIONS
from support.pictures.corpus import HARD
from support.pictures.empty_clamps import CLAMPS
from support.pictures.stale_clamps import SINCE

#: Of the doors in the table of docs/localization.md [m].
THIN, MIDDLE, THICK = 0.03, 0.05, 0.1


def _distance(thickness: float) -> float:
    return load_layout().rear_face_x - thickness - number_of("config/camera.yaml#mounting.x")


def _pixel(thickness: float) -> float:
    k = load_camera().k
    return _distance(thickness) * float(1.0 / k[0, 0] + 1.0 / k[1, 1]) / 2.0


#: From the camera to the face, and a pixel of the face, mean of both directions [m].
THIN_DISTANCE, MIDDLE_DISTANCE, THICK_DISTANCE = map(_distance, (THIN, MIDDLE, THICK))
THIN_PIXEL, MIDDLE_PIXEL, THICK_PIXEL = map(_pixel, (THIN, MIDDLE, THICK))


def apart_on_door() -> float:
    """How far apart on a face lenses may show one ray that are taken for the same [m]."""
    return SAME * MIDDLE_PIXEL


def axis_from_hinge_edge() -> float:
    """Where the optical axis meets the wood [m]."""
    return number_of("config/camera.yaml#mounting.slider_y") - load_layout().centre_y


def axis_above_bottom_edge() -> float:
    """Where the optical axis meets the wood [m]."""
    return number_of("config/camera.yaml#mounting.z") - load_layout().bottom_z


def seen_further_in_y() -> float:
    """By how much a door of 50 mm seems to stand further in y, a unit of thickness."""
    return axis_from_hinge_edge() / MIDDLE_DISTANCE


def seen_further_in_z() -> float:
    """The same in z."""
    return axis_above_bottom_edge() / MIDDLE_DISTANCE


def _known_in_y(thickness: float) -> float:
    """Standard deviation of a pose in y [m] where the thickness of the door is known to so much [m]."""
    mounting = number_of("config/camera.yaml#localizer.mounting_deviation.0")
    return float(np.hypot(seen_further_in_y() * thickness, mounting))


def known_as_shipped() -> float:
    """Standard deviation of y with the shipped deviation of the thickness [m]."""
    return _known_in_y(number_of("config/camera.yaml#localizer.thickness_deviation"))


def known_when_measured() -> float:
    """The same with a thickness that was measured to 0.05 mm [m]."""
    return _known_in_y(5e-5)


def _slab(thicker: float) -> float:
    """By how much a door of 50 mm that is thicker seems to stand off in the y-z plane [m]."""
    away = np.hypot(axis_from_hinge_edge(), axis_above_bottom_edge())
    return float(away * thicker / (MIDDLE_DISTANCE - thicker))


def as_told() -> float:
    """A door 0.3 mm thicker than its recipe [m]."""
    return _slab(3e-4)


def _bow(length: float) -> float:
    """Sagitta of an edge [m] that is bowed by 0.3 mm over 400 mm, over so much of it [m]."""
    return 3e-4 * (length / 0.4) ** 2


SHORT_BOW, LONG_BOW = _bow(0.06), _bow(0.15)


ROUGH, WANDERS = 1.5e-5, 2.0e-3  # m


def _open(length: float) -> float:
    """Standard deviation of the bow over 400 mm that a rough edge leaves open where `length` shows [m]."""
    return ROUGH * 0.4**2 * float(np.sqrt(11.25 * np.sqrt(np.pi) * WANDERS / length**5))


HINGE_SHOWS, BOTTOM_SHOWS = 0.08, 0.13  # m
HINGE_OPEN, BOTTOM_OPEN = _open(HINGE_SHOWS), _open(BOTTOM_SHOWS)


def conditions() -> float:
    """Conditions of the pictures that the localizer was not made for."""
    return float(len(CONDITIONS))


def clamp_kinds() -> float:
    """Kinds of pictures with one of the empty clamp."""
    return float(len(CLAMPS))


def happenings() -> float:
    """Kinds of what may have happened since the picture of the empty clamp."""
    return float(len(SINCE))


def half_a_pixel() -> float:
    """Of a face 50 mm thick: what binning by two shifts the picture by [m]."""
    return MIDDLE_PIXEL / 2.0


def spoilt_ways() -> float:
    """Ways in which pictures of the corpus are spoilt."""
    return float(len(HARD))
