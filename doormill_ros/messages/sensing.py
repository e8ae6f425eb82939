"""Readings of door sensors, read into what the domain computes with; as `from_message`, without ROS."""

from __future__ import annotations

from typing import Any

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization.sensors.errors import BadReading
from doormill_ros.localization.sensors.sensor import ReadingKind
from doormill_ros.messages.from_message import positions_of
from doormill_ros.messages.picture import picture_of

#: The list of a doormill_interfaces/SensorReading that holds a reading of each kind.
LISTS: dict[ReadingKind, str] = {
    "picture": "pictures",
    "pictures": "pictures",
    "distances": "distances",
    "points": "points",
}
MOST = 1000  #: distances or points of a reading, and more than any sensor has pictures


def reading_of(message: Any, takes: ReadingKind) -> ByteArray | FloatArray | dict[str, ByteArray]:
    """What `DoorSensor.locate` takes, from a message with the fields of SensorReading.

    Returns:
        A picture, shape (h, w), uint8; pictures by camera name; distances, shape (n,) [m]; or points, shape (n, 3) [m].

    Raises:
        BadReading: Another list is filled than the sensor's, or none, or two pictures are of one camera.
        BadPicture: A picture is damaged or of a kind that is not read.
    """
    counts = {name: len(getattr(message, name)) for name in sorted(set(LISTS.values()))}
    wanted = LISTS[takes]
    others = any(count for name, count in counts.items() if name != wanted)
    if others or not 0 < counts[wanted] <= MOST or (takes == "picture" and counts[wanted] != 1):
        found = ", ".join(f"{count} {name}" for name, count in counts.items())
        allowed = "one picture" if takes == "picture" else f"1 to {MOST} {wanted} and nothing else"
        raise BadReading(f"the reading holds {found}, allowed are {allowed}; check the sensor's driver")
    if takes == "distances":
        return np.array(message.distances, dtype=float)
    if takes == "points":
        return positions_of(message.points)
    if takes == "picture":
        return picture_of(message.pictures[0])
    names = [str(picture.header.frame_id) for picture in message.pictures]
    if len(set(names)) < len(names):
        raise BadReading(
            f"the pictures are of the cameras {names}, allowed is one of each; let the driver write the camera's name "
            "into header.frame_id"
        )
    return {name: picture_of(picture) for name, picture in zip(names, message.pictures, strict=True)}
