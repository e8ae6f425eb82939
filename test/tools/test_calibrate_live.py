"""Calibrating by what a camera sends: a process of its own listens to a real topic."""

from __future__ import annotations

import io
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
import rclpy
import yaml
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from doormill_ros.localization.camera import load_camera
from doormill_ros.nodes.convert.picture import picture_message
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene, Surface
from support.pictures.uneven_boards import session
from support.waiting import LIMIT

TOPIC = "/calibrate_live/image_raw"


@pytest.fixture
def camera() -> Iterator[Node]:
    context = Context()
    rclpy.init(context=context)
    node = Node("board_camera", context=context)
    yield node
    node.destroy_node()
    rclpy.shutdown(context=context)


def calibrate(*arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "doormill_ros.tools.calibrate", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def test_boards_are_taken_until_no_view_is_missing(camera: Node, tmp_path: Path) -> None:
    truth = session(24)
    pictures = [np.full(truth.camera.shape, 90, np.uint8), *truth.pictures(24)]
    publisher = camera.create_publisher(
        Image, TOPIC, QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    )
    out, saved = tmp_path / "camera.yaml", tmp_path / "boards"
    arguments = ["--topic", TOPIC, "--square", "20", "--out", str(out), "--save", str(saved), "--wait", "240"]
    process = calibrate("intrinsics", *arguments)
    end, i = time.monotonic() + LIMIT, 0
    while process.poll() is None and time.monotonic() < end:
        publisher.publish(picture_message(pictures[i // 4 % len(pictures)], Header()))
        i += 1
        time.sleep(0.1)
    said, errors = process.communicate(timeout=LIMIT)
    assert process.returncode == 0, errors
    assert "001.png taken; show " in errors
    assert "that is all" in errors
    assert "the same view as " in errors
    assert "missing" not in said
    assert abs(load_camera(out).k[0, 0] / truth.true[0] - 1.0) < 5e-3
    assert len(list(saved.glob("*.png"))) >= 12
    # What was saved calibrates the same without the camera.
    again = tmp_path / "again.yaml"
    files = [str(path) for path in sorted(saved.glob("*.png"))]
    assert calibrate("intrinsics", *files, "--square", "20", "--out", str(again)).wait(LIMIT) == 0
    np.testing.assert_allclose(load_camera(again).k, load_camera(out).k, rtol=1e-9)


def test_a_topic_without_a_camera_is_told(tmp_path: Path) -> None:
    process = calibrate(
        "intrinsics", "--topic", "/nobody", "--square", "20", "--out", str(tmp_path / "a.yaml"), "--wait", "1"
    )
    _, errors = process.communicate(timeout=LIMIT)
    assert process.returncode == 2
    assert (
        errors == "calibration: no picture came on /nobody within 1 s; start the camera, or name its topic\n"
    )


def test_neither_files_nor_topic_is_told(tmp_path: Path) -> None:
    process = calibrate("intrinsics", "--square", "20", "--out", str(tmp_path / "a.yaml"))
    _, errors = process.communicate(timeout=LIMIT)
    assert process.returncode == 2
    assert "neither pictures nor a topic" in errors


def test_a_moved_door_is_asked_for_and_written_down(camera: Node, tmp_path: Path) -> None:
    """The door is not one, so the calibration refuses; the pictures are in their files."""
    publisher = camera.create_publisher(Image, TOPIC, 1)
    moves = tmp_path / "moves.yaml"
    entries = [{"picture": f"{i}.png", "move": [0, 10 * i, 0]} for i in range(2)]
    moves.write_text(yaml.safe_dump({"width": 800, "height": 2000, "thickness": 50, "pictures": entries}))
    process = subprocess.Popen(
        [sys.executable, "-m", "doormill_ros.tools.calibrate", "check", str(moves), "--topic", TOPIC],
        stdin=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert isinstance(process.stdin, io.TextIOBase)
    process.stdin.write("\n\n")
    process.stdin.flush()
    end = time.monotonic() + LIMIT
    while process.poll() is None and time.monotonic() < end:
        publisher.publish(picture_message(np.full((1080, 1920), 77, np.uint8), Header()))
        time.sleep(0.2)
    _, errors = process.communicate(timeout=LIMIT)
    assert process.returncode == 2
    assert "door of 50 mm to x, y, z = 0, 10, 0 mm from the reference place, then Enter: " in errors
    assert cv2.imread(str(tmp_path / "1.png"))[3, 3].tolist() == [77, 77, 77]


def test_the_empty_clamp_is_taken_from_a_topic(camera: Node, tmp_path: Path) -> None:
    scene = PictureScene(0.826, 0.04, background=Surface(0.2, mottle=0.05, mottle_size=4e-3), door=False)
    picture = render_picture(scene, 3)
    publisher = camera.create_publisher(
        Image, TOPIC, QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    )
    out = tmp_path / "camera.yaml"
    arguments = ["--topic", TOPIC, "--width", "826", "--count", "3", "--out", str(out), "--wait", "120"]
    process = calibrate("empty", *arguments)
    end = time.monotonic() + LIMIT
    while process.poll() is None and time.monotonic() < end:
        publisher.publish(picture_message(picture, Header()))
        time.sleep(0.1)
    said, complaint = process.communicate(timeout=LIMIT)
    assert process.returncode == 0, complaint
    assert "the empty clamp for doors of 826 mm: 3 pictures" in said
    np.testing.assert_array_equal(load_camera(out).empty[0].picture, picture)
