"""Three cameras, one for each axis: six degrees of freedom (thesis section 3.7, figure 3.17)."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.cell.places.layout import CellLayout, load_layout
from doormill_ros.config import read
from doormill_ros.frames import transform
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.sensors.corner_edges import EdgeRays, PictureQuality, find_corner_edges
from doormill_ros.localization.sensors.edge_rays import depth, miss
from doormill_ros.localization.sensors.errors import BadReading, BadSensorFile
from doormill_ros.localization.sensors.faces import Face
from doormill_ros.localization.sensors.fit import Linearised, fit_pose
from doormill_ros.localization.sensors.freedom import ClampFreedom, load_freedom
from doormill_ros.localization.sensors.sensor import DoorPoseEstimate, MountingDeviation, ReadingKind
from doormill_ros.recipes.door import DoorSize
from doormill_ros.resources import resource
from doormill_ros.values import Array, Count, Finite, NotNegative, Positive, Section, Vector3

FORM = "config/sensors/axis_vision.yaml"


@dataclass(frozen=True, eq=False)
class AxisCamera:
    """One of the three cameras.

    Attributes:
        name: "1", "2" or "3".
        looks_at: The face it sees, a key of `faces.OUTWARD`.
        place: Projection centre from the nominal corner, base axes [m], shape (3,).
        fixed_x: Base x at which it stands [m], or None when it follows the thickness.
        rotation: R_base_camera, shape (3, 3).
    """

    name: str
    looks_at: str
    place: FloatArray
    fixed_x: float | None
    rotation: FloatArray

    def T_base_camera(self, layout: CellLayout, door: DoorSize) -> FloatArray:
        """Where the sliders put it for a door, shape (4, 4)."""
        position = layout.T_base_door(door.width, door.thickness)[:3, 3] + self.place
        if self.fixed_x is not None:
            position[0] = self.fixed_x
        return transform(self.rotation, position)


@dataclass(frozen=True, eq=False)
class AxisVision:
    """The three cameras as one door sensor; `reading` maps camera names to pictures (h, w), uint8.

    Attributes:
        layout: Where the nominal door stands.
        freedom: What the clamp can hold.
        lens: Intrinsics of all cameras.
        cameras: The cameras.
        position_deviation: Standard deviation of a camera's place along an axis [m].
        rotation_deviation: Standard deviation of its direction about an axis [rad].
        roughness: RMS of the edges about their lines [m].
        correlation: Distance over which the roughness changes [m].
        quality: Noise and least contrast of the pictures.
        seconds: Exposure and transfer [s].
    """

    layout: CellLayout
    freedom: ClampFreedom
    lens: CameraModel
    cameras: tuple[AxisCamera, ...]
    position_deviation: float
    rotation_deviation: float
    roughness: float
    correlation: float
    quality: PictureQuality
    seconds: float
    name: str = "axis_vision"
    takes: ReadingKind = "pictures"
    cannot_see: str = (
        "the door beyond 15 cm from its corner, so a warped or twisted leaf; chips and dust on an edge "
        "count as edge unless they stand out; needs light, clean lenses and three calibrated places"
    )

    def locate(self, reading: dict[str, ByteArray], door: DoorSize) -> DoorPoseEstimate:
        """Pose of the door from one picture (h, w) of each camera, by its name.

        Raises:
            BadReading: A picture is missing or of another size.
            EdgeNotFound: A picture shows no edge where one must be.
            Contradiction: The edges do not belong to one door.
            PoseOutOfRange: The pose cannot be.
        """
        begun = time.perf_counter()
        edges = [(camera, rays) for camera in self.cameras for rays in self._edges(camera, reading, door)]
        nominal = self.layout.T_base_door(door.width, door.thickness)
        places = {camera.name: camera.T_base_camera(self.layout, door) for camera in self.cameras}
        covariance = self._covariance(edges, nominal, places)

        def linearise(T_base_door: FloatArray) -> Linearised:
            parts = [miss(T_base_door, places[camera.name], e.axis, e.rays) for camera, e in edges]
            return Linearised(
                -np.concatenate([p[0] for p in parts]), np.vstack([p[1] for p in parts]), covariance
            )

        fit = fit_pose(nominal, linearise, "edge points")
        deviations = np.sqrt(np.diag(fit.covariance))
        self.freedom.check(fit.T_base_door, deviations, self.layout, door)
        return DoorPoseEstimate(
            fit.T_base_door,
            fit.covariance,
            (True,) * 6,
            self.seconds + time.perf_counter() - begun,
            fit.chi_square,
            fit.redundancy,
            {"edge_points": {f"{camera.name}{'xyz'[e.axis]}": len(e.rays) for camera, e in edges}},
        )

    def _edges(self, camera: AxisCamera, reading: dict[str, ByteArray], door: DoorSize) -> list[EdgeRays]:
        picture = reading.get(camera.name)
        width, height = self.lens.size
        if picture is None or picture.shape != (height, width) or picture.dtype != np.uint8:
            found = "nothing" if picture is None else f"{picture.dtype} {picture.shape}"
            raise BadReading(
                f"camera {camera.name} sent {found}, allowed is uint8 ({height}, {width}); check the camera",
                camera=camera.name,
            )
        nominal = self.layout.T_base_door(door.width, door.thickness)
        place = camera.T_base_camera(self.layout, door)
        return find_corner_edges(
            picture,
            self.lens,
            place,
            nominal,
            camera.looks_at,
            door,
            self.freedom.limits,
            self.quality,
            f"camera {camera.name}",
        )

    def _covariance(
        self, edges: list[tuple[AxisCamera, EdgeRays]], T_base_door: FloatArray, places: dict[str, FloatArray]
    ) -> FloatArray:
        """Of all misses, shape (n, n): roughness along each edge, noise, and each camera's place."""
        focal = self.lens.focal
        mounting = np.repeat([self.position_deviation, self.rotation_deviation], 3) ** 2
        total = sum(len(e.rays) for _, e in edges)
        out, begin = np.zeros((total, total)), 0
        sway = np.zeros((total, 6 * len(self.cameras)))
        for camera, e in edges:
            part = slice(begin, begin + len(e.rays))
            T_base_camera = places[camera.name]
            far = depth(T_base_door, T_base_camera, e.axis, e.along)
            alike = np.exp(-np.abs(e.along[:, None] - e.along) / self.correlation)
            out[part, part] = self.roughness**2 * alike / np.outer(far, far)
            out[part, part] += np.eye(len(e.rays)) * (e.deviation / focal) ** 2
            column = 6 * self.cameras.index(camera)
            sway[part, column : column + 6] = miss(T_base_door, T_base_camera, e.axis, e.rays)[2]
            begin = part.stop
        covariance: FloatArray = out + sway * np.tile(mounting, len(self.cameras)) @ sway.T
        return covariance


@dataclass(frozen=True, eq=False)
class _Camera(Section):
    """One camera; `right` and `down` are its picture's axes in base."""

    name: str | int
    looks_at: Face
    place: Vector3
    right: Vector3
    down: Vector3
    x: Finite | None = None

    def camera(self) -> AxisCamera:
        """As the sensor uses it."""
        return AxisCamera(
            name=str(self.name),
            looks_at=self.looks_at,
            place=self.place,
            fixed_x=self.x,
            rotation=np.column_stack([self.right, self.down, np.cross(self.right, self.down)]),
        )


@dataclass(frozen=True, eq=False)
class _Lens(Section):
    size: tuple[Count, Count]
    k: Annotated[FloatArray, Array((3, 3))]
    distortion: Annotated[FloatArray, Array((5,))]


@dataclass(frozen=True)
class _Edges(Section):
    roughness: NotNegative
    correlation: Positive


@dataclass(frozen=True, eq=False)
class _SensorFile(Section):
    cameras: tuple[_Camera, ...]
    intrinsics: _Lens
    mounting_deviation: MountingDeviation
    edges: _Edges
    picture: PictureQuality
    exposure_time: NotNegative


def load_axis_vision(path: Path | None = None, layout: CellLayout | None = None) -> AxisVision:
    """Read config/sensors/axis_vision.yaml, or another file of the same form.

    Raises:
        BadSensorFile: A key is missing or unknown, a value impossible or a camera looks at no known face.
        BadCameraFile: The intrinsics are out of bounds.
    """
    layout = layout or load_layout()
    content = read(path or resource(FORM), _SensorFile, BadSensorFile, f"compare it with {FORM}")
    lens = content.intrinsics
    return AxisVision(
        layout=layout,
        freedom=load_freedom(layout),
        lens=CameraModel(lens.k, lens.distortion, lens.size, np.zeros(3), np.zeros(3)),
        cameras=tuple(entry.camera() for entry in content.cameras),
        position_deviation=content.mounting_deviation.position,
        rotation_deviation=content.mounting_deviation.rotation,
        roughness=content.edges.roughness,
        correlation=content.edges.correlation,
        quality=content.picture,
        seconds=content.exposure_time,
    )
