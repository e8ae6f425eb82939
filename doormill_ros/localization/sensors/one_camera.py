"""The single camera of the cell as one door sensor among others: y, z and the rotation about x."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from doormill_ros.cell.layout import CellLayout, load_layout
from doormill_ros.localization.camera import CameraModel, load_camera
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.sensors.freedom import ClampFreedom, load_freedom
from doormill_ros.localization.sensors.sensor import DoorPoseEstimate, DoorSize

_SEEN = (1, 2, 3)  # y, z, rotation x
_EXPOSURE = 0.060  # s, exposure and transfer, as for the three cameras


@dataclass(frozen=True, eq=False)
class OneCamera:
    """`localize` behind the seam; `reading` is a picture (h, w), uint8.

    Attributes:
        layout: Where the nominal door stands.
        freedom: What the clamp can hold.
        camera: The camera.
    """

    layout: CellLayout
    freedom: ClampFreedom
    camera: CameraModel
    name: str = "one_camera"
    cannot_see: str = (
        "x and the rotations about y and z: a door that stands 1 mm closer looks 0.6 % larger, which the "
        "pose then holds; the door beyond 15 cm from its corner"
    )

    def locate(self, reading: np.ndarray, door: DoorSize) -> DoorPoseEstimate:
        """Pose of the door from one picture.

        Raises:
            LocalizationError: Whatever `localize` refuses.
        """
        begun = time.perf_counter()
        found = localize(reading, self.camera, self.layout, door.width, door.thickness)
        covariance = np.diag(self.freedom.held**2)
        covariance[np.ix_(_SEEN, _SEEN)] = found.covariance
        points = sum(int(edge.inlier.sum()) for edge in found.edges)
        return DoorPoseEstimate(
            found.T_base_door,
            covariance,
            tuple(i in _SEEN for i in range(6)),
            _EXPOSURE + time.perf_counter() - begun,
            float("nan"),
            points - len(_SEEN),
            {"quality": found.quality, "inlier_share": found.inlier_share},
        )


def load_one_camera() -> OneCamera:
    """The camera of config/camera.yaml in the cell of config/cell.yaml."""
    layout = load_layout()
    return OneCamera(layout, load_freedom(layout), load_camera())
