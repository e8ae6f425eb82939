"""Every door sensor by name. A new one is a file beside this and a line here."""

from __future__ import annotations

from doormill_ros.localization.sensors.axis_vision import load_axis_vision
from doormill_ros.localization.sensors.one_camera import load_one_camera
from doormill_ros.localization.sensors.photoelectric import load_photoelectric
from doormill_ros.localization.sensors.sensor import SensorLoader
from doormill_ros.localization.sensors.touch_probe import load_touch_probe

SENSORS: dict[str, SensorLoader] = {
    "one_camera": load_one_camera,
    "axis_vision": load_axis_vision,
    "photoelectric": load_photoelectric,
    "touch_probe": load_touch_probe,
}
