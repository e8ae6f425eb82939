"""One picture for every reason to refuse one."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization import errors
from doormill_ros.localization.localizer import localize
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import BackEdge, Edges, Light, PictureScene, Sensor, Surface
from doormill_ros.units import DEG, MM

WIDTH, THICKNESS = 0.9, 0.05


@pytest.fixture(scope="module")
def scene():
    return PictureScene(
        WIDTH,
        THICKNESS,
        DoorOffset(0.004, -0.003, 0.012),
        face=Surface(0.6, mottle=0.03, grain=0.04),
        background=Surface(0.2, mottle=0.05),
        edges=Edges(0.02 * MM),
        sensor=Sensor(blur=1.0, read_noise=1.5),
    )


@pytest.fixture(scope="module")
def good(scene):
    return render_picture(scene, 5)


def test_the_unspoilt_picture_is_accepted(good, camera, layout):
    assert localize(good, camera, layout, WIDTH, THICKNESS).quality > 0.4


SPOILT = {
    "no door": (errors.NoEdge, {"offset": DoorOffset(0.3, 0.3, 0.0)}),
    "taper": (errors.WrongEdge, {"edges": Edges(0.02 * MM, squareness=0.3 * DEG)}),
    "edge beside edge": (errors.WrongEdge, {"back_edge": BackEdge(0.8 * MM, 0.0, 0.3 * MM, 0.6)}),
    "ragged": (errors.TooFewInliers, {"edges": Edges(0.4 * MM, correlation=1.5 * MM)}),
    "too far left": (errors.OutOfRange, {"offset": DoorOffset(0.0104, 0.0, 0.0)}),
    "far below": (errors.OutOfRange, {"offset": DoorOffset(0.0, -0.017, 0.0)}),
    "turned": (errors.OutOfRange, {"offset": DoorOffset(0.0, 0.0, 2.6 * DEG)}),
    "out of focus": (errors.Blurred, {"sensor": Sensor(defocus=9.0)}),
    "glare": (errors.OverExposed, {"light": Light(level=8.0)}),
    "white face": (errors.OverExposed, {"light": Light(level=2.2)}),
    "dark": (errors.UnderExposed, {"light": Light(level=0.02)}),
}


@pytest.mark.parametrize("name", SPOILT)
def test_spoilt_picture_is_refused_with_its_reason(name, scene, camera, layout):
    reason, change = SPOILT[name]
    picture = render_picture(replace(scene, **change), 5)
    with pytest.raises(errors.LocalizationError) as refusal:
        localize(picture, camera, layout, WIDTH, THICKNESS)
    assert type(refusal.value) is reason, refusal.value.message
    assert len(refusal.value.message.split()) > 8


def test_stale_picture(good, camera, layout):
    with pytest.raises(errors.StalePicture, match=r"3\.00 s old, allowed are 2\.00 s"):
        localize(good, camera, layout, WIDTH, THICKNESS, age=3.0)
    with pytest.raises(errors.StalePicture):
        localize(good, camera, layout, WIDTH, THICKNESS, age=float("nan"))
    with pytest.raises(errors.StalePicture, match=r"3600\.00 s in the future"):
        localize(good, camera, layout, WIDTH, THICKNESS, age=-3600.0)


def test_camera_info_missing(good, layout):
    with pytest.raises(errors.CameraInfoMissing):
        localize(good, None, layout, WIDTH, THICKNESS)


def test_camera_info_of_another_size(good, camera, layout):
    other = camera.with_intrinsics(camera.k, camera.distortion, (1280, 720))
    with pytest.raises(errors.CameraInfoSize, match="1280 x 720 px, the picture has 1920 x 1080"):
        localize(good, other, layout, WIDTH, THICKNESS)


@pytest.mark.parametrize("picture", [np.zeros((1080, 1920, 3), np.uint8), np.zeros((1080, 1920)), None])
def test_not_a_grey_picture(picture, camera, layout):
    with pytest.raises(errors.BadPicture):
        localize(picture, camera, layout, WIDTH, THICKNESS)


def test_every_reason_has_its_own_code():
    leaves = errors.LocalizationError.__subclasses__()
    codes = [leaf.code for leaf in leaves]
    assert len(leaves) >= 12
    assert len(set(codes)) == len(codes)
    assert all(200 < code < 300 for code in codes)
