"""Distances that six laser triangulation sensors read off a true door."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout, load_layout
from doormill_ros.config import read_document
from doormill_ros.recipes.door import DoorSize
from doormill_ros.resources import resource
from doormill_ros.simulation.errors import SceneFileError
from doormill_ros.simulation.sensors.nominal_door import FACES, beside, nominal_corner, spot_on_face
from doormill_ros.simulation.sensors.rig import SimulatedReading

_AIM = 2.0e-4  # how well a beam's direction is set up, standard deviation [rad]


@dataclass(frozen=True, eq=False)
class PhotoelectricRig:
    """The true rig.

    Attributes:
        document: config/sensors/photoelectric.yaml.
        layout: Where the nominal door stands.
        linearity: Whether the characteristic bends as the data sheet allows.
    """

    document: dict[str, Any]
    layout: CellLayout
    linearity: bool = True

    @staticmethod
    def load(path: Path | None = None, linearity: bool = True) -> PhotoelectricRig:
        """The rig of config/sensors/photoelectric.yaml."""
        path = path or resource("config/sensors/photoelectric.yaml")
        return PhotoelectricRig(read_document(path, SceneFileError), load_layout(), linearity)

    def sense(self, T_base_door: FloatArray, door: DoorSize, seed: int) -> SimulatedReading:
        """See `SensorRig.sense`."""
        return SimulatedReading(
            distances=self.read(T_base_door, door.width, door.height, door.thickness, seed)
        )

    def read(
        self, T_base_door: FloatArray, width: float, height: float, thickness: float, seed: int
    ) -> FloatArray:
        """Averaged distances, shape (6,) [m]; nan where the beam meets no door inside the range.

        Args:
            T_base_door: True pose of the door, shape (4, 4).
            width: Door width [m].
            height: Door height [m].
            thickness: Door thickness [m].
            seed: Draws mounting, characteristic, wood and noise.
        """
        rng = np.random.default_rng(seed)
        extent = np.array([thickness, width, height])
        corner = nominal_corner(self.layout, width, thickness)
        return np.array(
            [self._beam(beam, T_base_door, extent, corner, rng) for beam in self.document["beams"]]
        )

    def _beam(
        self,
        beam: dict[str, Any],
        T_base_door: FloatArray,
        extent: FloatArray,
        corner: FloatArray,
        rng: np.random.Generator,
    ) -> float:
        axis = FACES[beam["face"]]
        aim = np.eye(3)[axis]  # straight along the nominal normal
        start = corner + spot_on_face(beam, extent) - self.document["stand_off"] * aim
        # In door coordinates the face is where one coordinate vanishes.
        local = np.linalg.solve(T_base_door, np.append(start, 1.0))[:3]
        looking = aim + rng.normal(0.0, _AIM, 3)
        looking = T_base_door[:3, :3].T @ (looking / np.linalg.norm(looking))
        distance = -local[axis] / looking[axis]
        hit = local + distance * looking
        if beside(hit, axis, extent):
            return float("nan")
        return self._electronics(distance + rng.normal(0.0, self.document["surface"]), rng)

    def _electronics(self, distance: float, rng: np.random.Generator) -> float:
        sensor = self.document["sensor"]
        low, high = sensor["range"]
        bent = distance + rng.normal(0.0, self.document["mounting_deviation"])
        phase, waves = rng.uniform(0.0, 2 * np.pi), rng.uniform(0.7, 1.5)
        if self.linearity:
            bent += sensor["linearity"] * np.sin(phase + 2 * np.pi * waves * (distance - low) / (high - low))
        single = bent + rng.normal(0.0, sensor["noise"], self.document["readings"])
        if not low <= bent <= high:
            return float("nan")
        return float(np.mean(np.round(single / sensor["resolution"]) * sensor["resolution"]))
