"""From what a door sensor read to the pose of the door; `look` does the same with the camera's picture."""

from __future__ import annotations

from typing import Any, Protocol

from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.sensors.sensor import DoorPoseEstimate, DoorSensor
from doormill_ros.messages.sensing import reading_of
from doormill_ros.recipes.door import DoorSize


class DoorBody(Protocol):
    """What a sensor has to know of a door: a recipe or the message that holds one [m]."""

    width: float
    height: float
    thickness: float


def sense(reading: Any, sensor: DoorSensor, door: DoorBody) -> DoorPoseEstimate:
    """Find the door in a reading.

    Args:
        reading: A doormill_interfaces/SensorReading, from a driver or from a bag.
        sensor: That took it.
        door: Its size.

    Raises:
        LocalizationError: One of its leaves, the reason for a refusal; its sentence names the sensor.
    """
    size = DoorSize(width=float(door.width), height=float(door.height), thickness=float(door.thickness))
    try:
        return sensor.locate(reading_of(reading, sensor.takes), size)
    except LocalizationError as error:
        raise type(error)(f"{sensor.name}: {error.message}", **error.data) from error
