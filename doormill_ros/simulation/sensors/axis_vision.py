"""Pictures of the door's corner by three cameras, rendered from a true door pose."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import ndtr

from doormill_ros.arrays import ByteArray, Float32Array, FloatArray
from doormill_ros.cell.places.layout import CellLayout, load_layout
from doormill_ros.config import read_document
from doormill_ros.recipes.door import DoorSize
from doormill_ros.resources import resource
from doormill_ros.simulation.errors import SceneFileError
from doormill_ros.simulation.picture.optics import expose, rays
from doormill_ros.simulation.picture.scene import SceneCamera, Sensor
from doormill_ros.simulation.sensors.nominal_door import FACES, nominal_corner
from doormill_ros.simulation.sensors.rig import SimulatedReading

_FINE = 4  # sub-pixels along each axis beside an edge
_BAND = 8.0  # px on both sides of an edge that are drawn finely
_GRID = 1.0e-4  # step of the roughness [m]


@dataclass(frozen=True, eq=False)
class AxisVisionRig:
    """The true cameras and edges.

    Attributes:
        document: config/sensors/axis_vision.yaml.
        layout: Where the nominal door stands.
        sensor: Optics and noise.
        face: Brightness of the door.
        background: Brightness behind it.
    """

    document: dict[str, Any]
    layout: CellLayout
    sensor: Sensor = field(default_factory=Sensor)
    face: float = 0.62
    background: float = 0.16

    @staticmethod
    def load(path: Path | None = None, **changes: Any) -> AxisVisionRig:
        """The rig of config/sensors/axis_vision.yaml; `changes` set other attributes."""
        path = path or resource("config/sensors/axis_vision.yaml")
        return AxisVisionRig(read_document(path, SceneFileError), load_layout(), **changes)

    def sense(self, T_base_door: FloatArray, door: DoorSize, seed: int) -> SimulatedReading:
        """See `SensorRig.sense`."""
        return SimulatedReading(
            pictures=self.take(T_base_door, door.width, door.height, door.thickness, seed)
        )

    def take(
        self,
        T_base_door: FloatArray,
        width: float,
        height: float,
        thickness: float,
        seed: int,
        rig_seed: int | None = None,
    ) -> dict[str, ByteArray]:
        """A picture (h, w), uint8, of each camera by name.

        Args:
            T_base_door: True pose of the door, shape (4, 4).
            width: Door width [m].
            height: Door height [m].
            thickness: Door thickness [m].
            seed: Draws light and noise.
            rig_seed: Draws mountings and edges; None for `seed`.
        """
        extent = np.array([thickness, width, height])
        rig_seed = seed if rig_seed is None else rig_seed
        return {
            str(entry["name"]): self._picture(
                entry,
                T_base_door,
                extent,
                self.stand(i, width, thickness, rig_seed),
                np.random.default_rng([rig_seed, i, 1]),
                np.random.default_rng([seed, i, 2]),
            )
            for i, entry in enumerate(self.document["cameras"])
        }

    def stand(
        self, index: int, width: float, thickness: float, rig_seed: int
    ) -> tuple[FloatArray, FloatArray]:
        """True projection centre, shape (3,) [m], and camera axes as columns, shape (3, 3), base, both a little off."""
        entry = self.document["cameras"][index]
        rng = np.random.default_rng([rig_seed, index, 0])
        centre = nominal_corner(self.layout, width, thickness) + entry["place"]
        if "x" in entry:
            centre[0] = entry["x"]
        right, down = np.array(entry["right"], float), np.array(entry["down"], float)
        axes = np.column_stack([right, down, np.cross(right, down)])
        off = self.document["mounting_deviation"]
        turn = Rotation.from_rotvec(rng.normal(0.0, off["rotation"], 3)).as_matrix()
        return centre + rng.normal(0.0, off["position"], 3), turn @ axes

    def _picture(
        self,
        entry: dict[str, Any],
        T_base_door: FloatArray,
        extent: FloatArray,
        stand: tuple[FloatArray, FloatArray],
        saw: np.random.Generator,
        rng: np.random.Generator,
    ) -> ByteArray:
        inner = self.document["intrinsics"]
        camera = SceneCamera(
            np.array(inner["k"]), np.array(inner["distortion"]), tuple(inner["size"][::-1]), np.zeros(3)
        )
        rows, columns = camera.shape
        centre, axes = stand
        T_door_base = np.linalg.inv(T_base_door)
        eye = T_door_base[:3, :3] @ centre + T_door_base[:3, 3]
        look = T_door_base[:3, :3] @ axes
        flat = FACES[entry["looks_at"]]
        first, second = (i for i in range(3) if i != flat)
        # Edge of coordinate `first` runs along `second` and the other way round.
        wobble = {i: self._roughness(saw) for i in (first, second)}

        def inside(x: FloatArray | Float32Array, y: FloatArray | Float32Array) -> list[FloatArray]:
            """How far within each of the four edges rays x, y meet the face [px]."""
            along = [look[i, 0] * x + look[i, 1] * y + look[i, 2] for i in range(3)]
            reach = -eye[flat] / along[flat]
            a, b = (eye[i] + reach * along[i] for i in (first, second))
            pixel = reach / camera.matrix[0, 0]
            return [
                (a - _along(wobble[first], b)) / pixel,
                (b - _along(wobble[second], a)) / pixel,
                (extent[first] - a) / pixel,
                (extent[second] - b) / pixel,
            ]

        x, y = rays(camera, (0, rows, 0, columns), 1)
        within = np.minimum.reduce(inside(x, y))
        share = (within > 0).astype(np.float32)
        v, u = np.nonzero(np.abs(within) < _BAND)
        x0, y0, fine = x[v, u].astype(float), y[v, u].astype(float), np.zeros(v.size)
        steps = (np.arange(_FINE) + 0.5) / _FINE - 0.5
        for du in steps:
            for dv in steps:
                edges = inside(x0 + du / camera.matrix[0, 0], y0 + dv / camera.matrix[1, 1])
                fine += np.multiply.reduce([ndtr(e / self.sensor.blur) for e in edges])
        share[v, u] = fine / _FINE**2
        radiance = (self.background + (self.face - self.background) * share) * self._light(camera, rng)
        return expose(radiance.astype(np.float32), self.sensor, rng)

    def _roughness(self, rng: np.random.Generator) -> FloatArray:
        """How far the edge stands off its line every _GRID from the corner, a first-order process [m]."""
        edges, n = self.document["edges"], int(0.4 / _GRID)
        keep = np.exp(-_GRID / edges["correlation"])
        steps = rng.normal(0.0, edges["roughness"] * np.sqrt(1 - keep**2), n)
        steps[0] = rng.normal(0.0, edges["roughness"])
        out, last = np.empty(n), 0.0
        for i, step in enumerate(steps):
            last = keep * last + step
            out[i] = last
        return out

    def _light(self, camera: SceneCamera, rng: np.random.Generator) -> FloatArray:
        """Smooth change of light and of the wood's brightness over the picture, mean 1."""
        rows, columns = camera.shape
        coarse = 1.0 + 0.04 * rng.standard_normal((5, 8)).astype(np.float32)
        light: FloatArray = cv2.resize(coarse, (columns, rows), interpolation=cv2.INTER_CUBIC)
        return light


def _along(wobble: FloatArray, where: FloatArray) -> FloatArray:
    """Roughness at places [m] along the edge, linear between its grid points."""
    place = np.clip(where / _GRID, 0, wobble.size - 1.001)
    low = place.astype(np.int32)
    return wobble[low] + (place - low) * (wobble[low + 1] - wobble[low])
