"""Every registered sensor answers in the same form."""

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.frames import check_transform
from doormill_ros.localization.sensors.registry import SENSORS
from doormill_ros.localization.sensors.sensed_door import DEGREES_OF_FREEDOM
from doormill_ros.recipes.door import DoorSize
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene
from doormill_ros.simulation.sensors.axis_vision import AxisVisionRig
from doormill_ros.simulation.sensors.photoelectric import PhotoelectricRig
from doormill_ros.simulation.sensors.touch_probe import TouchProbeRig
from doormill_ros.units import DEG, MM

DOOR = DoorSize(width=0.826, height=2.04, thickness=0.040)
OFFSET = DoorOffset(3.0 * MM, -2.0 * MM, 0.7 * DEG)
T_BASE_DOOR = load_layout().T_base_door(DOOR.width, DOOR.thickness, OFFSET)


def _reading(name):
    if name == "one_camera":
        return render_picture(PictureScene(DOOR.width, DOOR.thickness, OFFSET), 1)
    size = (DOOR.width, DOOR.height, DOOR.thickness)
    if name == "axis_vision":
        return AxisVisionRig.load().take(T_BASE_DOOR, *size, seed=1)
    if name == "photoelectric":
        return PhotoelectricRig.load().read(T_BASE_DOOR, *size, seed=1)
    return TouchProbeRig.load().touch(T_BASE_DOOR, *size, seed=1, count=9)


def test_the_thesis_sensors_are_registered():
    assert set(SENSORS) == {"one_camera", "axis_vision", "photoelectric", "touch_probe"}


@pytest.mark.parametrize("name", sorted(SENSORS))
def test_every_sensor_answers_in_the_same_form(name):
    sensor = SENSORS[name]()
    assert sensor.name == name
    assert len(sensor.cannot_see) > 20
    estimate = sensor.locate(_reading(name), DOOR)
    check_transform(estimate.T_base_door)
    assert estimate.covariance.shape == (6, 6)
    assert np.all(np.linalg.eigvalsh(estimate.covariance) > 0)
    assert estimate.seconds > 0
    assert estimate.redundancy >= 0
    assert len(estimate.sees) == len(DEGREES_OF_FREEDOM)
    found = load_layout().offset_of(estimate.T_base_door, DOOR.width)
    y, z, rotation = estimate.deviations[1:4]
    assert abs(found.y - OFFSET.y) < 4 * y
    assert abs(found.z - OFFSET.z) < 4 * z
    assert abs(found.rotation - OFFSET.rotation) < 4 * rotation


def test_one_camera_says_what_it_is_blind_for():
    estimate = SENSORS["one_camera"]().locate(_reading("one_camera"), DOOR)
    assert estimate.blind == ("x", "rotation y", "rotation z")
    np.testing.assert_allclose(estimate.deviations[[0, 4, 5]], [3e-4, 5e-4, 5e-4])  # clamp.yaml, no more
