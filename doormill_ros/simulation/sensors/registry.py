"""What each door sensor of a simulated cell reads, by name. A new one is a file beside this and a line here."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.recipes.door import DoorSize
from doormill_ros.simulation.sensors.axis_vision import AxisVisionRig
from doormill_ros.simulation.sensors.photoelectric import PhotoelectricRig
from doormill_ros.simulation.sensors.touch_probe import TouchProbeRig

TOUCHES = 12  #: six give a pose, the others a check


@dataclass(frozen=True, eq=False)
class SimulatedReading:
    """What a sensor read; the kinds that it does not read are empty.

    Attributes:
        distances: Along beams, shape (n,) [m]; nan for nothing.
        points: Reported centres of a probe's ball, base axes, shape (n, 3) [m].
        pictures: Of each camera by its name, shape (h, w), uint8.
    """

    distances: FloatArray = field(default_factory=lambda: np.empty(0))
    points: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    pictures: dict[str, ByteArray] = field(default_factory=dict)


#: Arguments: true pose of the door, shape (4, 4), its size, and what draws everything that is drawn.
SensorTruth = Callable[[FloatArray, DoorSize, int], SimulatedReading]


def _three_cameras(T_base_door: FloatArray, door: DoorSize, seed: int) -> SimulatedReading:
    rig = AxisVisionRig.load()
    return SimulatedReading(pictures=rig.take(T_base_door, door.width, door.height, door.thickness, seed))


def _six_beams(T_base_door: FloatArray, door: DoorSize, seed: int) -> SimulatedReading:
    rig = PhotoelectricRig.load()
    return SimulatedReading(distances=rig.read(T_base_door, door.width, door.height, door.thickness, seed))


def _probe(T_base_door: FloatArray, door: DoorSize, seed: int) -> SimulatedReading:
    """By the arm of the simulated cell, which has no geometric error when it mills, and so none when it probes."""
    rig = TouchProbeRig.load()
    robot = {**rig.document["robot"], "accuracy": 0.0}
    rig = replace(rig, document={**rig.document, "robot": robot})
    with suppress(ValueError):  # it passed beside the door and touched nothing
        points = rig.touch(T_base_door, door.width, door.height, door.thickness, seed, TOUCHES)
        return SimulatedReading(points=points)
    return SimulatedReading()


SIMULATED_SENSORS: dict[str, SensorTruth] = {
    "axis_vision": _three_cameras,
    "photoelectric": _six_beams,
    "touch_probe": _probe,
}
