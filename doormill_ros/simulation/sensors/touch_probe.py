"""What a robot reports when its switching probe touches a true door."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
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

_WAVES = 200  # of the robot's error field; enough to be normally distributed
_TOUCHES = 12  # six give a pose, the others a check


@dataclass(frozen=True, eq=False)
class TouchProbeRig:
    """The true probe, robot and wood.

    Attributes:
        document: config/sensors/touch_probe.yaml.
        layout: Where the nominal door stands.
    """

    document: dict[str, Any]
    layout: CellLayout

    @staticmethod
    def load(path: Path | None = None) -> TouchProbeRig:
        """The rig of config/sensors/touch_probe.yaml."""
        path = path or resource("config/sensors/touch_probe.yaml")
        return TouchProbeRig(read_document(path, SceneFileError), load_layout())

    def sense(self, T_base_door: FloatArray, door: DoorSize, seed: int) -> SimulatedReading:
        """See `SensorRig.sense`; the arm of the simulated cell has no geometric error, neither milling nor probing."""
        robot = {**self.document["robot"], "accuracy": 0.0}
        rig = replace(self, document={**self.document, "robot": robot})
        with suppress(ValueError):  # it passed beside the door and touched nothing
            points = rig.touch(T_base_door, door.width, door.height, door.thickness, seed, _TOUCHES)
            return SimulatedReading(points=points)
        return SimulatedReading()

    def robot_error(self, points: FloatArray, seed: int) -> FloatArray:
        """Where the robot really is minus where it believes to be, at points (n, 3); shape (n, 3) [m].

        A sum of waves with normally distributed wave vectors has a Gaussian correlation.
        """
        rng, robot = np.random.default_rng([seed, 7]), self.document["robot"]
        waves = rng.normal(0.0, 1.0 / robot["correlation_length"], (3, _WAVES, 3))
        phases = rng.uniform(0.0, 2 * np.pi, (3, _WAVES))
        field = [np.cos(points @ w.T + p).sum(axis=1) for w, p in zip(waves, phases, strict=True)]
        off: FloatArray = robot["accuracy"] * np.sqrt(2.0 / _WAVES) * np.column_stack(field)
        return off

    def touch(
        self,
        T_base_door: FloatArray,
        width: float,
        height: float,
        thickness: float,
        seed: int,
        count: int = 6,
    ) -> FloatArray:
        """Reported centres of the ball, shape (count, 3) [m].

        Args:
            T_base_door: True pose of the door, shape (4, 4).
            width: Door width [m].
            height: Door height [m].
            thickness: Door thickness [m].
            seed: Draws the robot's error, its scatter, probe and wood.
            count: How many points of the file, in its order.

        Raises:
            ValueError: A point lies beside the door.
        """
        rng = np.random.default_rng(seed)
        probe, robot = self.document["probe"], self.document["robot"]
        ball = probe["radius"] + rng.normal(0.0, probe["radius_deviation"])
        bend = probe["pre_travel"] + rng.normal(0.0, probe["pre_travel_deviation"])
        bend += robot["compliance"] * probe["trigger_force"] * rng.uniform(1 / 3, 1.0)
        extent = np.array([thickness, width, height])
        corner = nominal_corner(self.layout, width, thickness)
        points = (self.document["points"] + self.document["more_points"])[:count]
        reported = []
        for point in points:
            axis = FACES[point["face"]]
            into = np.eye(3)[axis]  # the search goes straight along the nominal normal
            begin = corner + spot_on_face(point, extent) - self.document["motion"]["clearance"] * into
            local = np.linalg.solve(T_base_door, np.append(begin, 1.0))[:3]
            toward = T_base_door[:3, :3].T @ into
            way = (-ball - local[axis] + rng.normal(0.0, self.document["surface"])) / toward[axis]
            contact = local + way * toward
            if beside(contact, axis, extent):
                raise ValueError(
                    f"the probe passes beside the door's {point['face']} at {contact.tolist()} m"
                )
            reported.append(begin + (way + bend + rng.normal(0.0, probe["repeatability"])) * into)
        actual = np.array(reported)
        scatter = rng.normal(0.0, robot["repeatability"], actual.shape)
        return actual - self.robot_error(actual, seed) - scatter
