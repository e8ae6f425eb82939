"""Readings of door sensors."""

from __future__ import annotations

import array
from collections.abc import Mapping

from geometry_msgs.msg import Point
from std_msgs.msg import Header

from doormill_interfaces.msg import SensorReading
from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.nodes.convert.picture import picture_message


def reading_message(
    sensor: str,
    run_id: str,
    header: Header,
    distances: FloatArray,
    points: FloatArray,
    pictures: Mapping[str, ByteArray],
) -> SensorReading:
    """A reading of one kind; the two others are empty.

    Args:
        sensor: As config/cell.yaml names it.
        run_id: Of the latest recipe.
        header: With the time of the reading.
        distances: Along beams, shape (n,) [m].
        points: In base_link, shape (n, 3) [m].
        pictures: By camera, shape (h, w), uint8.
    """
    message = SensorReading(header=header, sensor=sensor, run_id=run_id)
    message.distances = array.array("d", distances.tolist())
    message.points = [Point(x=x, y=y, z=z) for x, y, z in points.tolist()]
    message.pictures = [
        picture_message(picture, Header(stamp=header.stamp, frame_id=name))
        for name, picture in pictures.items()
    ]
    return message
