"""Node /sensor_simulator: what the cell's sensors beside the camera read off the door that the simulation clamped."""

from __future__ import annotations

import zlib
from typing import Any

from std_msgs.msg import Header

from doormill_interfaces.msg import DoorPlacement, DoorRecipe, SensorReading
from doormill_ros.cell.graph.door_sensors import chosen_sensors
from doormill_ros.cell.graph.node_names import SENSOR_SIMULATOR
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.frames import BASE_FRAME
from doormill_ros.messages.from_message import recipe_of, transform_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import OK
from doormill_ros.nodes.convert.sensing import reading_message
from doormill_ros.nodes.sensing.requested_sensor import RequestedSensor
from doormill_ros.nodes.sensing.sensors_parameter import SENSORS_PARAMETER
from doormill_ros.recipes.door import DoorSize
from doormill_ros.simulation.sensors.registry import SIMULATED_SENSORS


class SensorSimulator(RequestedSensor):
    """Plays the drivers of all sensors of the cell but the camera; one that is not simulated reads nothing."""

    PARAMETERS = (
        SENSORS_PARAMETER,
        NodeParameter("seed", 0, "of what the sensors draw, with the door's id", 0, 2**31 - 1, live=True),
        NodeParameter("retry_period", 1.0, "a reading that nobody used is sent again after [s]", 0.1, 3600.0),
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(SENSOR_SIMULATOR, **kwargs)

    def setup(self) -> None:
        """Subscribe, where there is a sensor to be played.

        Raises:
            BadParameterError: The list of sensors is none.
        """
        self._names = [
            name for name in chosen_sensors(load_layout(), self.value("sensors")) if name in SIMULATED_SENSORS
        ]
        if not self._names:
            return
        self._recipe: DoorRecipe | None = None
        self._placement: DoorPlacement | None = None
        self._readings: list[SensorReading] = []
        self._doors = 0
        self._reading = self.publisher(topics.SENSOR_READING)
        self.open_sensor(self.value("retry_period"))
        self.subscribe(topics.DOOR_RECIPE, self._take_recipe)
        self.subscribe(topics.DOOR_PLACEMENT, self._take_placement)

    def start(self) -> None:
        """Say so where there is nothing to do."""
        if not self._names:
            self.report(OK, "at rest: no sensor beside the camera is simulated")

    def _take_recipe(self, recipe: DoorRecipe) -> None:
        self._recipe = recipe
        self._read()

    def _take_placement(self, placement: DoorPlacement) -> None:
        self._placement = placement
        self._read()

    def _read(self) -> None:
        """Read the door once it is known what it is and where it stands."""
        message, placement = self._recipe, self._placement
        if message is None or placement is None or message.run_id != placement.run_id:
            return
        if not self.is_new(message.run_id):
            return
        recipe, T_base_door = recipe_of(message), transform_of(placement.pose)
        door = DoorSize(width=recipe.width, height=recipe.height, thickness=recipe.thickness)
        text = f"{self.value('seed')} {self._doors} {recipe.door_id}"
        self._doors += 1
        found = [
            (name, SIMULATED_SENSORS[name]().sense(T_base_door, door, zlib.crc32(f"{text} {name}".encode())))
            for name in self._names
        ]
        self._readings = [
            reading_message(name, message.run_id, Header(), read.distances, read.points, read.pictures)
            for name, read in found
        ]
        self.want(message.run_id)
        self.report(OK, "door read", door_id=recipe.door_id, sensors=", ".join(self._names))

    def send(self, run_id: str) -> None:
        """Send what every sensor read."""
        for reading in self._readings:
            stamp = self.get_clock().now().to_msg()
            reading.header = Header(stamp=stamp, frame_id=BASE_FRAME)
            for picture in reading.pictures:
                picture.header.stamp = stamp
            self._reading.publish(reading)
