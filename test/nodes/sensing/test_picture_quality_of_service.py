"""The localizer takes pictures from a driver that offers sensor data quality, and loses none of a reliable one."""

from __future__ import annotations

from pathlib import Path

import pytest
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

from doormill_interfaces.srv import GetRecipe
from doormill_ros.localization.camera import load_camera
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.convert.picture import camera_info_message, picture_message
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene
from support.cell_processes import CellProcesses


@pytest.mark.parametrize(
    "offered", [qos_profile_sensor_data, topics.PICTURE], ids=["sensor data", "reliable"]
)
def test_a_picture_of_a_camera_driver_is_localized(offered: QoSProfile, tmp_path: Path) -> None:
    recipe, camera = shipped_recipes()["standard_door"], load_camera()
    picture = render_picture(PictureScene(width=recipe.width, thickness=recipe.thickness), 1)
    with CellProcesses(tmp_path, nodes=("recipe_database", "door_localizer")) as cell:
        found = cell.subscribe(topics.DOOR_LOCALIZATION)
        cell.ask(GetRecipe, "recipes/get", GetRecipe.Request(door_id="standard_door", run_id="r1"))
        image = cell.node.create_publisher(Image, "camera/image_raw", offered)
        info = cell.node.create_publisher(CameraInfo, "camera/camera_info", offered)

        def answered() -> bool:
            # A driver sends picture after picture; some may be lost.
            stamp = cell.node.get_clock().now().to_msg()
            message = picture_message(picture, camera_header(stamp))
            info.publish(camera_info_message(camera.k, camera.distortion, camera.size, message.header))
            image.publish(message)
            return any(m.accepted for m in found)

        cell.wait(answered, pause=0.3)
    first = next(m for m in found if m.accepted)
    assert first.run_id == "r1"
    assert abs(first.offset_y) < 1e-4


def camera_header(stamp: object) -> object:
    return Header(stamp=stamp, frame_id="camera_optical_frame")
