"""What a node that finds doors tells of them: one line for all sensors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from geometry_msgs.msg import PoseStamped

from doormill_interfaces.msg import DoorLocalization, SensorLocalization
from doormill_ros.arrays import FloatArray
from doormill_ros.cell.graph.door_sensors import chosen_sensors
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.localization.result import FREE
from doormill_ros.localization.sensors.registry import registered
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.convert.geometry import pose_message
from doormill_ros.nodes.sensing.sensors_parameter import SENSORS_PARAMETER


class PoseTeller:
    """The first of the cell's sensors tells path and bridge; where there are several, each tells who compares them.

    Args:
        node: With the parameter `sensors`; make this in its `setup`.
        sensor: Whose node it is.
        layout: Of the cell.

    Attributes:
        chosen: Whether the sensor is one of the cell's.
        first: Whether it is the one from whose pose is milled.
        sensors: All of them.

    Raises:
        BadParameterError: The list of sensors is none.
        BadSensorFile: It names one that does not exist.
    """

    def __init__(self, node: ManagedNode, sensor: str, layout: CellLayout) -> None:
        self._sensor = sensor
        self._layout = layout
        self.sensors = chosen_sensors(layout, node.value(SENSORS_PARAMETER.name))
        registered(self.sensors)
        self.chosen = sensor in self.sensors
        self.first = self.sensors[0] == sensor
        if self.first:
            self._pose = node.publisher(topics.DOOR_POSE)
            self._localization = node.publisher(topics.DOOR_LOCALIZATION)
        several = self.chosen and len(self.sensors) > 1
        self._beside = node.publisher(topics.SENSOR_LOCALIZATION) if several else None

    @property
    def at_rest(self) -> str:
        """What a node says of itself whose sensor is none of the cell's."""
        return f"at rest: doors are found by {', '.join(self.sensors)}"

    def refuse(self, answer: DoorLocalization) -> None:
        """Tell why there is no pose."""
        if self._beside is not None:
            self._beside.publish(self._beside_of(answer))
        if self.first:
            self._localization.publish(answer)

    def tell(
        self,
        answer: DoorLocalization,
        T_base_door: FloatArray,
        width: float,
        covariance: FloatArray,
        sees: Sequence[bool],
    ) -> None:
        """Tell where the door stands.

        Args:
            answer: With run, stamp, duration, residual and quality.
            T_base_door: The pose, shape (4, 4).
            width: Of the door [m].
            covariance: Of the twist to the truth, base axes, shape (6, 6); counts where the sensor sees.
            sees: Which degrees of freedom it measures.
        """
        answer.accepted = True
        answer.pose.pose = pose_message(T_base_door)
        offset = self._layout.offset_of(T_base_door, width)
        answer.offset_y, answer.offset_z, answer.offset_rotation = offset.y, offset.z, offset.rotation
        if self._beside is not None:
            beside = self._beside_of(answer)
            seen = np.array(sees, dtype=float)
            beside.sees = [bool(value) for value in sees]
            beside.pose.pose = answer.pose.pose
            beside.pose.covariance = (covariance * np.outer(seen, seen)).ravel()
            self._beside.publish(beside)
        if self.first:
            free = np.zeros((6, 6))
            free[np.ix_(FREE, FREE)] = covariance[np.ix_(FREE, FREE)]
            answer.pose.covariance = free.ravel()
            self._pose.publish(PoseStamped(header=answer.header, pose=answer.pose.pose))
            self._localization.publish(answer)

    def _beside_of(self, answer: DoorLocalization) -> SensorLocalization:
        shared = ("header", "run_id", "door_id", "accepted", "error_code", "reason", "duration")
        return SensorLocalization(sensor=self._sensor, **{name: getattr(answer, name) for name in shared})
