"""What is taken for a picture of the empty clamp, and why others are not."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.calibration.empty_picture import NOISIEST, empty_picture
from doormill_ros.localization.calibration.errors import BadCalibrationFile, DoorInClamp, TooFewPictures
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import CameraInfoSize, CameraMoved, OverExposed, UnderExposed
from doormill_ros.simulation.picture.optics import expose
from doormill_ros.simulation.picture.picture import exposure, render_picture
from doormill_ros.simulation.picture.scene import PictureScene, Sensor, Surface
from support.pictures.marked_cell import marked_cameras

WIDTH = 0.826
WALL = Surface(0.2, mottle=0.05, mottle_size=4e-3)
SENSOR = Sensor(read_noise=1.5, gain=0.001)
EMPTY = PictureScene(WIDTH, 0.04, background=WALL, sensor=SENSOR, door=False)


def made(*pictures, camera=None, **options):
    return empty_picture(pictures, camera or load_camera(), load_layout(), WIDTH, **options)


@pytest.fixture(scope="module")
def empty():
    return render_picture(EMPTY, 1)


def test_noise_is_what_the_sensor_has_and_goes_down_with_their_number():
    light = exposure(EMPTY, np.random.default_rng(1))
    pictures = [expose(light, SENSOR, np.random.default_rng(i)) for i in range(5)]
    true = np.sqrt(SENSOR.read_noise**2 + SENSOR.gain * 255 * WALL.brightness + 1 / 12)  # and rounding
    one, four = made(pictures[0]), made(*pictures[:4])
    assert (one.count, four.count) == (1, 4)
    assert one.noise == pytest.approx(true, rel=0.05)
    assert four.noise == pytest.approx(true / 2, rel=0.05)
    # Against a picture of its own noise.
    assert (four.picture - pictures[4].astype(float)).std() == pytest.approx(
        np.hypot(true, np.hypot(true / 2, 12**-0.5)), rel=0.05
    )


def test_light_that_changes_between_them_is_no_movement(empty):
    darker = np.rint(empty * 0.8).astype(np.uint8)
    assert made(empty, darker).count == 2


def test_what_was_moved_between_them_is_told_with_its_place(empty):
    other = empty.copy()
    other[400:480, 800:960] = 160
    with pytest.raises(
        BadCalibrationFile, match=r"about u = (8|9)\d\d, v = 4\d\d px, .* something was moved"
    ):
        made(empty, other)


def test_a_door_is_told_unless_somebody_is_sure():
    door = render_picture(replace(EMPTY, door=True), 1)
    with pytest.raises(DoorInClamp, match="take the door out, or give --sure") as refused:
        made(door)
    scene = EMPTY
    corner = load_camera().project(load_layout().T_base_door(scene.width, scene.thickness)[:3, 3], WIDTH)
    np.testing.assert_allclose(refused.value.data["corner"], corner, atol=1.0)
    np.testing.assert_array_equal(made(door, sure=True).picture, door)


@pytest.mark.parametrize(
    ("change", "error"),
    [
        (lambda p: p[:-2], CameraInfoSize),
        (lambda p: np.where(np.arange(p.shape[1]) < 200, 255, p).astype(np.uint8), OverExposed),
        (lambda p: p // 32, UnderExposed),
    ],
)
def test_pictures_that_show_nothing_are_refused(change, error, empty):
    with pytest.raises(error):
        made(change(empty))


def test_noise_is_refused_with_the_number_of_pictures_that_would_do(empty):
    noisy = empty + np.random.default_rng(3).normal(0, 1.5 * NOISIEST, empty.shape)
    noisy = np.rint(np.clip(noisy, 0, 255)).astype(np.uint8)
    with pytest.raises(BadCalibrationFile, match=r"allowed are 4; give 3 pictures"):
        made(noisy)


def test_none_and_a_width_of_no_door_are_refused(empty):
    with pytest.raises(TooFewPictures):
        made()
    with pytest.raises(BadCalibrationFile, match="a door of 9000 mm, allowed are 100 to 3000 mm"):
        empty_picture([empty], load_camera(), load_layout(), 9.0)


def test_a_camera_that_has_moved_by_its_marks_takes_none():
    world, camera = marked_cameras()
    stands = replace(EMPTY, camera=world)
    assert made(render_picture(stands, 2), camera=camera).count == 1
    moved = replace(world, origin=world.origin + np.array([0.0, 3e-4, 0.0]))
    with pytest.raises(CameraMoved):
        made(render_picture(replace(stands, camera=moved), 2), camera=camera)
