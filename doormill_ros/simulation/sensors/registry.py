"""What plays each door sensor of a simulated cell, by name. A new one is a file beside this and a line here."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from doormill_ros.simulation.sensors.rig import SensorRig

RigLoader = Callable[[], "SensorRig"]


def _late(file: str, rig: str) -> RigLoader:
    """A rig's `load`, imported when it is called: the names stand in a command's help, which needs no numpy."""

    def load() -> SensorRig:
        found: SensorRig = getattr(import_module(f"doormill_ros.simulation.sensors.{file}"), rig).load()
        return found

    return load


SIMULATED_SENSORS: dict[str, RigLoader] = {
    "axis_vision": _late("axis_vision", "AxisVisionRig"),
    "photoelectric": _late("photoelectric", "PhotoelectricRig"),
    "touch_probe": _late("touch_probe", "TouchProbeRig"),
}
