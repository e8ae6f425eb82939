"""The single camera of the cell as one door sensor among others: y, z and the rotation about x."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.cell.places.layout import CellLayout, load_layout
from doormill_ros.config import read
from doormill_ros.localization.camera import CameraModel, load_camera
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.sensors.edge_rays import EDGES, miss, seen
from doormill_ros.localization.sensors.errors import BadSensorFile
from doormill_ros.localization.sensors.freedom import ClampFreedom, load_freedom
from doormill_ros.localization.sensors.sensor import DoorPoseEstimate, MountingDeviation, ReadingKind
from doormill_ros.localization.settings import shipped_settings
from doormill_ros.recipes.door import DoorSize
from doormill_ros.resources import resource
from doormill_ros.values import NotNegative, Section

FORM = "config/sensors/one_camera.yaml"

_SEEN, _HELD = [1, 2, 3], [0, 4, 5]  # y, z, rotation x; x, rotations y, z
_ALONG = np.linspace(0.012, 0.070, 12)  # m from the corner, where both edges show for every door


@dataclass(frozen=True, eq=False)
class OneCamera:
    """`localize` behind the seam; `reading` is a picture (h, w), uint8.

    Attributes:
        layout: Where the nominal door stands.
        freedom: What the clamp can hold.
        camera: The camera.
        position_deviation: Standard deviation of its place along an axis [m].
        rotation_deviation: Standard deviation of its direction about an axis [rad].
        seconds: Exposure and transfer [s].
    """

    layout: CellLayout
    freedom: ClampFreedom
    camera: CameraModel
    position_deviation: float
    rotation_deviation: float
    seconds: float
    name: str = "one_camera"
    takes: ReadingKind = "picture"
    cannot_see: str = (
        "x and the rotations about y and z: a door 1 mm off in x moves in y by a quarter of that in the picture, "
        "and the covariance can only allow for it; the door beyond 15 cm from its corner"
    )

    def locate(self, reading: ByteArray, door: DoorSize) -> DoorPoseEstimate:
        """Pose of the door from one picture, shape (h, w).

        Raises:
            LocalizationError: Whatever `localize` refuses.
        """
        begun = time.perf_counter()
        # `_unseen` tells in six degrees of freedom what the localiser's own settings tell in three.
        known = shipped_settings().picture_only()
        found = localize(reading, self.camera, self.layout, door.width, door.thickness, settings=known)
        covariance = self._unseen(found.T_base_door, door)
        covariance[np.ix_(_SEEN, _SEEN)] += found.covariance
        points = sum(int(edge.inlier.sum()) for edge in found.edges)
        return DoorPoseEstimate(
            found.T_base_door,
            covariance,
            tuple(i in _SEEN for i in range(6)),
            self.seconds + time.perf_counter() - begun,
            float("nan"),
            points - len(_SEEN),
            {"quality": found.quality, "inlier_share": found.inlier_share},
        )

    def _unseen(self, T_base_door: FloatArray, door: DoorSize) -> FloatArray:
        """Covariance (6, 6) from what no picture tells: the held degrees of freedom and the mounting.

        The picture fixes J_seen t_seen + J_held t_held + J_camera t_camera = 0 in the twists from what
        is assumed to what is true, so errors in the held ones reappear in those seen.
        """
        T_base_camera = self.camera.T_base_camera(door.width)
        parts = [
            miss(
                T_base_door, T_base_camera, EDGES[edge], seen(T_base_door, T_base_camera, EDGES[edge], _ALONG)
            )
            for edge in ("y", "z")
        ]
        by_door, by_camera = (np.vstack([part[i] for part in parts]) for i in (1, 2))
        causes = np.hstack([by_door[:, _HELD], by_camera])
        spread = np.diag(
            [
                *self.freedom.held[_HELD] ** 2,
                *[self.position_deviation**2] * 3,
                *[self.rotation_deviation**2] * 3,
            ]
        )
        effect = np.zeros((6, 9))
        effect[_SEEN] = -np.linalg.lstsq(by_door[:, _SEEN], causes, rcond=None)[0]
        effect[_HELD, range(3)] = 1.0
        return effect @ spread @ effect.T


@dataclass(frozen=True)
class _SensorFile(Section):
    exposure_time: NotNegative
    mounting_deviation: MountingDeviation


def load_one_camera(path: Path | None = None, layout: CellLayout | None = None) -> OneCamera:
    """The camera of config/camera.yaml with config/sensors/one_camera.yaml, or another file of its form.

    Raises:
        BadSensorFile: A key is missing or unknown, or a value impossible.
    """
    layout = layout or load_layout()
    content = read(path or resource(FORM), _SensorFile, BadSensorFile, f"compare it with {FORM}")
    mounting = content.mounting_deviation
    return OneCamera(
        layout,
        load_freedom(layout),
        load_camera(),
        mounting.position,
        mounting.rotation,
        content.exposure_time,
    )
