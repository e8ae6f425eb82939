"""The seam: what every simulated sensor of a cell is, and what it reads off a true door."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.recipes.door import DoorSize


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


class SensorRig(Protocol):
    """The true sensor of a simulated cell."""

    def sense(self, T_base_door: FloatArray, door: DoorSize, seed: int) -> SimulatedReading:
        """What it reads off a door.

        Args:
            T_base_door: True pose of the door, shape (4, 4).
            door: Its size.
            seed: Draws everything that is drawn.
        """
        ...
