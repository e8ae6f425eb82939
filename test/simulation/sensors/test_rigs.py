"""Every simulated sensor reads a true door, and what it reads is what the sensor of its name takes."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.localization.sensors.registry import SENSORS
from doormill_ros.recipes.door import DoorSize
from doormill_ros.simulation.sensors.registry import SIMULATED_SENSORS
from doormill_ros.units import DEG, MM

DOOR = DoorSize(width=0.826, height=2.04, thickness=0.040)
OFFSET = DoorOffset(2.0 * MM, -1.0 * MM, 0.5 * DEG)


@pytest.mark.parametrize("name", sorted(SIMULATED_SENSORS))
def test_a_rig_reads_what_its_sensor_takes(name: str) -> None:
    T_base_door = load_layout().T_base_door(DOOR.width, DOOR.thickness, OFFSET)
    read = SIMULATED_SENSORS[name]().sense(T_base_door, DOOR, 3)
    sensor = SENSORS[name]()
    assert [part.name for part in fields(read) if len(getattr(read, part.name))] == [sensor.takes]
    found = sensor.locate(getattr(read, sensor.takes), DOOR).T_base_door
    np.testing.assert_allclose(found[:3, 3], T_base_door[:3, 3], atol=1.0 * MM)


def test_a_probe_that_passes_beside_the_door_reads_nothing() -> None:
    far = load_layout().T_base_door(DOOR.width, DOOR.thickness, DoorOffset(0.0, 1.0, 0.0))
    assert not len(SIMULATED_SENSORS["touch_probe"]().sense(far, DOOR, 3).points)
