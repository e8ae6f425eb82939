"""The localizer's node in a cell with marks: doors are refused once the camera has moved, and it says since when."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rclpy.context import Context
from std_msgs.msg import Header

from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import CameraMoved
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.reporting_node import OK, WARN
from doormill_ros.nodes.convert.picture import picture_message
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene, SceneCamera
from support.localizer_node import Answers, Localizer
from support.pictures.marked_cell import marked_camera_file

MINUTE = 60


@pytest.fixture
def localizer(
    recorded: dict[str, bytes], context: Context, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Localizer]:
    marked = load_camera(marked_camera_file(tmp_path))
    monkeypatch.setattr("doormill_ros.nodes.door_localizer.load_camera", lambda: marked)
    localizer = Localizer(recorded, context)
    localizer.node._moved = localizer.moved = Answers()
    localizer.send(topics.CAMERA_INFO)
    yield localizer
    localizer.node.close()
    localizer.node.destroy_node()


def test_a_moved_camera_is_refused_told_with_its_time_and_recorded(
    localizer: Localizer, tmp_path: Path
) -> None:
    recipe = localizer.good[topics.DOOR_RECIPE.name]
    world = SceneCamera.load(tmp_path / "camera.yaml")
    start = 1_900_000_000 // MINUTE * MINUTE
    stood = time.strftime("%H:%M", time.localtime(start + MINUTE))
    way = np.array([0.0, 2e-4, 0.0])
    for minute, (camera, level) in enumerate(
        [
            (world, OK),
            (world, OK),
            (replace(world, origin=world.origin + 0.2 * way), WARN),
            (replace(world, origin=world.origin + way), WARN),
        ]
    ):
        scene = PictureScene(width=recipe.width, thickness=recipe.thickness, camera=camera)
        header = Header(frame_id="camera")
        header.stamp.sec = start + minute * MINUTE
        message = picture_message(render_picture(scene, minute), header)
        localizer.send(topics.IMAGE, header=header, data=message.data)
        answer = localizer.answers[-1]
        assert answer.accepted is (minute < 3), answer.reason
        assert localizer.node._health[0] == level
        shift = localizer.moved[-1]
        assert shift.header.stamp.sec == header.stamp.sec
        told = np.array([shift.twist.linear.x, shift.twist.linear.y, shift.twist.linear.z])
        assert np.abs(told - (camera.origin - world.origin)).max() < 1e-5
        said = localizer.node._health[1]
        if level == WARN:
            assert f"the camera has moved by {0.04 if minute == 2 else 0.2:.2f} mm since {stood}" in said
        else:
            assert said == "door found"
    assert answer.error_code == CameraMoved.code
    assert answer.reason.startswith("the camera has moved by 0.20 mm;")
    assert answer.run_id == recipe.run_id


def test_without_marks_nothing_is_said_of_the_camera(recorded: dict[str, bytes], context: Context) -> None:
    plain = Localizer(recorded, context)
    plain.send(topics.CAMERA_INFO)
    assert plain.answer().accepted
    assert "camera" not in plain.node._health[2]
    assert topics.CAMERA_MOVED.name not in {p.topic_name.lstrip("/") for p in plain.node.publishers}
    plain.node.close()
    plain.node.destroy_node()
