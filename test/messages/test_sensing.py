"""Readings of door sensors as messages: what is in them is read, what cannot be is refused in a sentence."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Point
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Header

from doormill_interfaces.msg import SensorReading
from doormill_ros.localization.errors import BadPicture
from doormill_ros.localization.sensors.errors import BadReading
from doormill_ros.messages.sensing import MOST, reading_of
from doormill_ros.nodes.convert.picture import picture_message
from doormill_ros.nodes.convert.sensing import reading_message

PICTURE = np.arange(64 * 80, dtype=np.uint8).reshape(64, 80)


def picture(name: str) -> Any:
    return picture_message(PICTURE, Header(frame_id=name))


def test_what_a_driver_sends_is_what_the_sensor_takes() -> None:
    """Over the wire, each kind as it was."""
    distances, points = np.array([0.05, np.nan, 0.06]), np.arange(9.0).reshape(3, 3)
    sent = [
        reading_message("s", "r", Header(), distances, np.empty((0, 3)), {}),
        reading_message("s", "r", Header(), np.empty(0), points, {}),
        reading_message("s", "r", Header(), np.empty(0), np.empty((0, 3)), {"1": PICTURE, "2": PICTURE.T}),
    ]
    one, two, three = (deserialize_message(serialize_message(message), SensorReading) for message in sent)
    np.testing.assert_array_equal(reading_of(one, "distances"), distances)
    np.testing.assert_array_equal(reading_of(two, "points"), points)
    pictures = reading_of(three, "pictures")
    assert isinstance(pictures, dict)
    np.testing.assert_array_equal(pictures["1"], PICTURE)
    np.testing.assert_array_equal(pictures["2"], PICTURE.T)
    np.testing.assert_array_equal(reading_of(SensorReading(pictures=[picture("x")]), "picture"), PICTURE)


@pytest.mark.parametrize(
    ("reading", "takes", "said"),
    [
        (SensorReading(), "distances", "0 distances, 0 pictures, 0 points"),
        (SensorReading(points=[Point()]), "distances", "1 points"),
        (SensorReading(points=[Point()], distances=[0.05]), "distances", "nothing else"),
        (SensorReading(distances=[0.05] * (MOST + 1)), "distances", f"1 to {MOST}"),
        (SensorReading(pictures=[picture("1"), picture("1")]), "pictures", "one of each"),
        (SensorReading(pictures=[picture("1"), picture("2")]), "picture", "one picture"),
    ],
)
def test_what_is_no_reading_of_the_sensor_is_refused(reading: SensorReading, takes: Any, said: str) -> None:
    with pytest.raises(BadReading, match=said):
        reading_of(reading, takes)


def test_a_damaged_picture_is_refused() -> None:
    damaged = picture("1")
    damaged.data = damaged.data[:-1]
    with pytest.raises(BadPicture):
        reading_of(SensorReading(pictures=[damaged]), "pictures")
