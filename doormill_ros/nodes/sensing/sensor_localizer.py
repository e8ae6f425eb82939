"""A node for one door sensor beside or instead of the camera: its readings in, the door's pose out, or why not."""

from __future__ import annotations

import time
from typing import Any

from std_msgs.msg import Header

from doormill_interfaces.msg import DoorLocalization, DoorRecipe, SensorReading
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.frames import BASE_FRAME, DOOR_FRAME
from doormill_ros.localization.sensors.registry import SENSORS
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.frame_publisher import FramePublisher
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import OK, WARN
from doormill_ros.nodes.sensing.pose_teller import PoseTeller
from doormill_ros.nodes.sensing.sensors_parameter import SENSORS_PARAMETER
from doormill_ros.pipeline.sense import sense
from doormill_ros.robot.urdf import LinkPose


class SensorLocalizer(ManagedNode):
    """Finds the door of the recipe in hand in every reading of its run."""

    PARAMETERS = (
        SENSORS_PARAMETER,
        NodeParameter(
            "frames", True, "publish the frame of the door when its pose is the one that is milled from"
        ),
    )

    def __init__(self, sensor: str, **kwargs: Any) -> None:
        """For a sensor of the registry, whose name the node takes."""
        self._name_of_sensor = sensor
        super().__init__(sensor, **kwargs)

    def setup(self) -> None:
        """Load the sensor's file; subscribe, where the cell has this sensor.

        Raises:
            BadSensorFile: The sensor's file lacks a key or holds a value out of bounds.
            BadParameterError: The list of sensors is none.
        """
        layout = load_layout()
        self._teller = PoseTeller(self, self._name_of_sensor, layout)
        if not self._teller.chosen:
            return
        self._sensor = SENSORS[self._name_of_sensor](layout=layout)
        self._recipe: DoorRecipe | None = None
        self._early: SensorReading | None = None
        self._frames = FramePublisher(self) if self.value("frames") and self._teller.first else None
        self.subscribe(topics.DOOR_RECIPE, self._take_recipe)
        self.subscribe(topics.SENSOR_READING, self._take_reading)

    def start(self) -> None:
        """Say so where there is nothing to do."""
        if not self._teller.chosen:
            self.report(OK, self._teller.at_rest)

    def _take_recipe(self, recipe: DoorRecipe) -> None:
        self._recipe = recipe
        early, self._early = self._early, None
        if early is not None and early.run_id == recipe.run_id:
            self._locate(early, recipe)

    def _take_reading(self, reading: SensorReading) -> None:
        if reading.sensor != self._name_of_sensor:
            return
        recipe = self._recipe
        if recipe is not None and reading.run_id == recipe.run_id:
            self._locate(reading, recipe)
            return
        # Topics have no common order: it may have overtaken its recipe.
        self._early = reading
        if recipe is not None:
            self.report(
                WARN,
                f"a reading of run {reading.run_id!r} was left aside, in hand is {recipe.run_id!r}; let the driver "
                "take run_id from the latest door/recipe",
            )

    def _locate(self, reading: SensorReading, recipe: DoorRecipe) -> None:
        answer = DoorLocalization(run_id=recipe.run_id, door_id=recipe.door_id)
        answer.header = Header(stamp=reading.header.stamp, frame_id=BASE_FRAME)
        begun = time.perf_counter()
        try:
            found = sense(reading, self._sensor, recipe)
        except Exception as unexpected:  # whatever it is, the run waits for an answer
            error = self.as_refusal(unexpected)
            answer.duration = time.perf_counter() - begun
            answer.error_code, answer.reason = error.code, error.message
            self._teller.refuse(answer)
            self.report(WARN, f"door {recipe.door_id}: {error.message}", error_code=error.code)
            return
        answer.duration = time.perf_counter() - begun
        answer.quality = found.quality
        self._teller.tell(answer, found.T_base_door, recipe.width, found.covariance, found.sees)
        self.report(OK, "door found", door_id=recipe.door_id, redundancy=found.redundancy)
        frames = self._frames
        if frames is not None:
            self.later("show", lambda: frames.show([LinkPose(BASE_FRAME, DOOR_FRAME, found.T_base_door)]))
