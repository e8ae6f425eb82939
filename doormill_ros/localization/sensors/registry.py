"""Every door sensor by name. A new one is a file beside this and a line here."""

from __future__ import annotations

from collections.abc import Iterable

from doormill_ros.cell.places.layout import CAMERA
from doormill_ros.localization.sensors.axis_vision import load_axis_vision
from doormill_ros.localization.sensors.errors import BadSensorFile
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
#: Those that are nodes beside /door_localizer in a cell: `one_camera` is its camera, asked from files.
CELL_SENSORS = tuple(name for name in SENSORS if name != "one_camera")


def registered(names: Iterable[str]) -> tuple[str, ...]:
    """The sensors of a list without the camera, which has a localizer of its own.

    Raises:
        BadSensorFile: One of them is none of a cell.
    """
    found = tuple(name for name in names if name != CAMERA)
    unknown = [name for name in found if name not in CELL_SENSORS]
    if unknown:
        allowed = ", ".join((CAMERA, *CELL_SENSORS))
        raise BadSensorFile(
            f"no cell has a sensor {unknown[0]!r}, allowed are {allowed}; correct `sensors` in config/cell.yaml"
        )
    return found
