"""From a picture to the pose of the door."""

from __future__ import annotations

from typing import Any, Protocol

from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.localization import checks
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.result import Localization
from doormill_ros.messages.picture import packed_size, picture_of


class DoorFace(Protocol):
    """What the localizer has to know of a door: a recipe or the message that holds one."""

    width: float
    thickness: float


def look(
    picture: Any, camera: CameraModel | None, layout: CellLayout, door: DoorFace, *, age: float = 0.0
) -> Localization:
    """Find the door in a picture message.

    Args:
        picture: A sensor_msgs/Image or sensor_msgs/CompressedImage, from a camera or from a bag.
        camera: The mounted camera with the intrinsics that came with the picture; None when none came.
        layout: Where the nominal door stands and how far it may be off.
        door: Its width and thickness [m].
        age: Time since the picture was taken [s]; 0 where pictures may be old.

    Returns:
        T_base_door and how sure it is.

    Raises:
        LocalizationError: One of its leaves, the reason for a refusal.
    """
    size = packed_size(picture)
    if size is not None and camera is not None:  # before anything of a wrong size is unpacked
        checks.check_size(size, camera)
    return localize(picture_of(picture), camera, layout, door.width, door.thickness, age=age)
