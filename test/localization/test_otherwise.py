"""Grey levels rounded otherwise, in pictures of little noise: a plain edge stays, a dark arris is right or refused."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.localizer import localize
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene, Sensor, Strip
from doormill_ros.units import DEG, MM
from support.pictures.conditions import pictures
from support.pictures.otherwise import OTHERWISE

# A door that stands straight crosses all rows at the same part of a pixel.
PLACES = ((-4.26, -2.55, 0.0), (2.03, -1.74, 0.0), (2.4, -1.69, 0.0), (3.88, -1.5, 0.0), (-4.0, -2.0, 1.0))
CALM = [
    PictureScene(0.9, 0.04, DoorOffset(y * MM, z * MM, turn * DEG), sensor=Sensor(read_noise=0.3, gain=0.001))
    for y, z, turn in PLACES
]


def off(picture, scene, camera, layout):
    """How far the pose found is from the true one [m]."""
    found = localize(picture, camera, layout, scene.width, scene.thickness).offset
    return np.hypot(found.y - scene.offset.y, found.z - scene.offset.z)


@pytest.fixture(scope="module")
def calm():
    return [(scene, render_picture(scene, 8)) for scene in CALM]


@pytest.mark.parametrize("way", OTHERWISE)
def test_a_plain_edge_is_found_however_its_grey_levels_are_rounded(way, calm, camera, layout):
    found = [off(OTHERWISE[way](picture), scene, camera, layout) for scene, picture in calm]
    assert max(found) < 0.02 * MM


@pytest.fixture(scope="module")
def burnt():
    rough = [(item.scene, render_picture(item.scene, item.seed)) for item in pictures("dark arris", 8, 9001)]
    scene = replace(
        CALM[1],
        strips=tuple(Strip(edge, -1.0, 0.2 * MM, 0.55) for edge in ("hinge", "bottom")),
    )
    return [*rough, (scene, render_picture(scene, 8))]


@pytest.mark.parametrize("way", [way for way in OTHERWISE if way != "Bayer pattern"])
def test_a_dark_arris_is_right_or_refused(way, burnt, camera, layout):
    found, reasons = [], []
    for scene, picture in burnt:
        try:
            found.append(off(OTHERWISE[way](picture), scene, camera, layout))
        except LocalizationError as refused:
            reasons.append(refused.message)
    assert max(found) < 0.1 * MM
    assert all("rim" in reason for reason in reasons), reasons
    assert len(found) >= 0.8 * len(burnt)
