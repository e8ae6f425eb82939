"""The exposure comes right from far too dark and far too bright, wherever the door may stand; then doors are found."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.gige.device import Limits
from doormill_ros.localization.gige.exposure import ENOUGH, ROUNDS, EdgeLight, exposed
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.view import face_view
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene

WIDTH, THICKNESS = 0.9, 0.04
LIMITS = Limits(1e-5, 1.0)
RIGHT = 0.01  # s with which a picture comes out as it was rendered
CAMERA, LAYOUT = load_camera(), load_layout()
LIGHT = EdgeLight(face_view(CAMERA, LAYOUT, WIDTH, THICKNESS), LAYOUT.limits)
#: At the limits of the placement.
PLACES = [DoorOffset(0.0, 0.0, 0.0), DoorOffset(0.0099, 0.0099, 0.034), DoorOffset(-0.0099, -0.0099, -0.034)]


@functools.cache
def rendered(place: int) -> np.ndarray:
    return render_picture(PictureScene(WIDTH, THICKNESS, PLACES[place]), 3)


class Sensor:
    """A linear one before a door in some light, 1 for the light it was rendered in."""

    def __init__(self, place: int, light: float) -> None:
        self._picture = rendered(place).astype(float) * light
        self.exposures: list[float] = []

    def take(self, exposure: float) -> np.ndarray:
        self.exposures.append(exposure)
        return np.clip(np.rint(self._picture * exposure / RIGHT), 0.0, 255.0).astype(np.uint8)


@pytest.mark.parametrize("place", range(len(PLACES)))
@pytest.mark.parametrize("light", [0.02, 0.1, 1.0, 10.0, 100.0])
def test_the_door_is_found_in_any_light(place: int, light: float) -> None:
    sensor = Sensor(place, light)
    taken = exposed(sensor.take, LIGHT, RIGHT, LIMITS)
    assert ENOUGH.low <= taken.level <= ENOUGH.high
    assert len(sensor.exposures) < ROUNDS
    assert sensor.exposures[-1] == taken.exposure
    found = localize(taken.picture, CAMERA, LAYOUT, WIDTH, THICKNESS).offset
    true = PLACES[place]
    assert np.hypot(found.y - true.y, found.z - true.z) < 1e-4


def test_one_that_will_do_is_left_alone() -> None:
    sensor = Sensor(0, 1.0)
    first = exposed(sensor.take, LIGHT, RIGHT, LIMITS)
    sensor.exposures.clear()
    again = exposed(sensor.take, LIGHT, first.exposure, LIMITS)
    assert sensor.exposures == [first.exposure] == [again.exposure]


@pytest.mark.parametrize(("light", "limit"), [(1e-3, LIMITS.high), (1e6, LIMITS.low), (0.0, LIMITS.high)])
def test_at_the_limit_the_best_there_is_is_taken(light: float, limit: float) -> None:
    sensor = Sensor(0, light)
    taken = exposed(sensor.take, LIGHT, RIGHT, LIMITS)
    assert taken.exposure == pytest.approx(limit, rel=1e-9)
    assert len(sensor.exposures) <= ROUNDS


def test_what_is_far_from_the_edges_does_not_count() -> None:
    """A lamp on the middle of the face, 40 mm from both edges: the face lies above and left of its corner."""
    picture = rendered(0).copy()
    view = face_view(CAMERA, LAYOUT, WIDTH, THICKNESS)
    u, v = view.pixels(np.array([[0.04, 0.04]]))[0].astype(int)
    picture[:v, :u] = 255
    assert np.mean(picture == 255) > 0.15
    assert LIGHT.level(picture) == LIGHT.level(rendered(0)) < 255


def test_a_bright_strip_at_the_edges_does() -> None:
    """Light that falls there alone would clip them while the picture as a whole is dark."""
    dark = (rendered(0) // 8).astype(np.uint8)
    view = face_view(CAMERA, LAYOUT, WIDTH, THICKNESS)
    lit = dark.copy()
    u, v = view.pixels(np.array([[0.0, 0.05]]))[0].astype(int)
    lit[:, u - 100 : u + 100] = 255
    lit[v - 100 : v + 100] = 255
    assert LIGHT.level(dark) < 40
    assert LIGHT.level(lit) == 255
