"""What plays each door sensor of a simulated cell, by name. A new one is a file beside this and a line here."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from doormill_ros.simulation.sensors.rig import SensorRig

RigLoader = Callable[[], "SensorRig"]


def late_rig(module: str, name: str) -> RigLoader:
    """`load` of a rig by the full name of its module, imported then: the sensors' names stand in a command's help."""

    def load() -> SensorRig:
        rig: SensorRig = getattr(import_module(module), name).load()
        return rig

    return load


SIMULATED_SENSORS: dict[str, RigLoader] = {
    "axis_vision": late_rig("doormill_ros.simulation.sensors.axis_vision", "AxisVisionRig"),
    "photoelectric": late_rig("doormill_ros.simulation.sensors.photoelectric", "PhotoelectricRig"),
    "touch_probe": late_rig("doormill_ros.simulation.sensors.touch_probe", "TouchProbeRig"),
}
