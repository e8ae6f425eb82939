"""What docs/localization.md prints: where the camera looks, and what a pixel is."""

from __future__ import annotations

from doormill_ros.cell.layout import load_layout
from doormill_ros.localization.camera import load_camera
from support.page_figures import number_of

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
