"""Six beams that look at the door of a picture beside the camera, as a cell with both sensors has them."""

from __future__ import annotations

from doormill_ros.cell.places.layout import CAMERA, load_layout
from doormill_ros.localization.result import Localization
from doormill_ros.localization.sensors.agreement import check_agreement
from doormill_ros.localization.sensors.registry import SENSORS
from doormill_ros.localization.sensors.sensed_door import SensedDoor
from doormill_ros.recipes.door import DoorSize
from doormill_ros.simulation.sensors.photoelectric import PhotoelectricRig
from support.pictures.conditions import ConditionPicture

BEAMS, HEIGHT = "photoelectric", 2.04


def compare(item: ConditionPicture, found: Localization) -> None:
    """What the bridge does before it mills.

    Raises:
        SensorsDisagree: Beams and camera are further apart than both state.
    """
    scene = item.scene
    T_base_door = load_layout().T_base_door(scene.width, scene.thickness, scene.offset)
    distances = PhotoelectricRig.load().read(T_base_door, scene.width, HEIGHT, item.thickness, item.seed)
    estimate = SENSORS[BEAMS]().locate(distances, DoorSize(HEIGHT, scene.width, item.thickness))
    check_agreement(
        [
            SensedDoor(CAMERA, found.T_base_door, found.whole_covariance, found.sees),
            SensedDoor(BEAMS, estimate.T_base_door, estimate.covariance, estimate.sees),
        ]
    )
