"""Frames on /tf, with tf2's messages where they are installed and with ours where they are not."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import pytest
import rclpy
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
from std_msgs.msg import Header
from visualization_msgs.msg import Marker

from doormill_interfaces.msg import TFMessage
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.frames import from_xyzw, rotation_x, transform
from doormill_ros.localization.camera import load_camera
from doormill_ros.messages.from_message import transform_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.frame_publisher import frame_topics, tf_message_class, transform_message
from doormill_ros.nodes.convert.geometry import pose_message
from doormill_ros.nodes.convert.recipe import recipe_message
from doormill_ros.nodes.path_generator import PathGenerator
from doormill_ros.nodes.process.spinning import SteadyExecutor
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.robot.description import load_robot
from support.source_tree import ROOT
from support.waiting import LIMIT

DOOR = "thesis_190_0deg"


def test_a_transform_says_what_its_matrix_says() -> None:
    T = transform(rotation_x(0.7), np.array([1.0, -2.0, 3.0]))
    message = transform_message("base_link", "door", T, Time(sec=5))
    assert (message.header.frame_id, message.child_frame_id, message.header.stamp.sec) == (
        "base_link",
        "door",
        5,
    )
    v, q = message.transform.translation, message.transform.rotation
    again = from_xyzw(np.array([v.x, v.y, v.z]), np.array([q.x, q.y, q.z, q.w]))
    assert np.abs(again - T).max() < 1e-12


class Generator:
    """A path generator and a node beside it."""

    def __init__(self) -> None:
        rclpy.init()
        self.generator, self.node = PathGenerator(), Node("beside")
        self.executor = SteadyExecutor(2)
        self.executor.add_node(self.generator)
        self.executor.add_node(self.node)
        self.thread = Thread(target=self.executor.spin, daemon=True)
        self.thread.start()
        self.generator.bring_up()

    def hear(self, message_type: Any, name: str, qos: Any) -> list[Any]:
        heard: list[Any] = []
        self.node.create_subscription(message_type, name, heard.append, qos)
        return heard

    def wait(self, condition: Callable[[], Any]) -> None:
        deadline = time.monotonic() + LIMIT
        while not condition():
            assert time.monotonic() < deadline, "waited in vain"
            time.sleep(0.02)

    def generate(self, run_id: str = "r1", found: bool = True) -> None:
        """Hand a recipe to the generator, and a pose if the door is found."""
        recipe = shipped_recipes()[DOOR]
        T_base_door = load_layout().T_base_door(recipe.width, recipe.thickness)
        names = (topics.DOOR_RECIPE, topics.DOOR_POSE)
        recipes, poses = (self.node.create_publisher(t.type, t.name, t.offered) for t in names)
        self.wait(lambda: min(p.get_subscription_count() for p in (recipes, poses)) >= 1)
        stamp = self.node.get_clock().now().to_msg()
        recipes.publish(recipe_message(recipe, run_id, Header(stamp=stamp)))
        if not found:
            return
        header = Header(stamp=self.node.get_clock().now().to_msg(), frame_id="base_link")
        poses.publish(PoseStamped(header=header, pose=pose_message(T_base_door)))

    def close(self) -> None:
        self.generator.close()
        self.executor.shutdown(timeout_sec=2.0)
        self.thread.join(2.0)
        self.generator.destroy_node()
        self.node.destroy_node()
        rclpy.try_shutdown()


@pytest.fixture
def running() -> Iterator[Generator]:
    generator = Generator()
    yield generator
    generator.close()


@pytest.fixture
def without_tf2(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "tf2_msgs", None)
    monkeypatch.setitem(sys.modules, "tf2_msgs.msg", None)


def test_without_tf2_s_messages_a_late_joiner_gets_the_latest_robot(
    without_tf2: None, running: Generator
) -> None:
    assert tf_message_class() is TFMessage
    targets = running.hear(topics.PATH_TARGETS.type, topics.PATH_TARGETS.name, topics.PATH_TARGETS.requested)
    running.generate()
    running.wait(lambda: targets)
    late = [running.hear(topic.type, topic.name, topic.requested) for topic in frame_topics()]
    running.wait(lambda: all(late))
    frames = chain(t for heard in late for message in heard for t in message.transforms)
    assert set(frames) == ROBOT_FRAMES
    corrected = transform_of(targets[-1].targets[0].corrected)
    assert np.abs(in_base(frames, "tool") - corrected).max() < 1e-6


def test_what_else_is_shown_is_published_too(running: Generator) -> None:
    kept = [topics.PATH_TARGETS, topics.PATH_CORRECTED, topics.PATH_JOINT_STATES, topics.ROBOT_DESCRIPTION]
    heard = {t.name: running.hear(t.type, t.name, t.requested) for t in kept}
    running.generate()
    running.wait(lambda: all(heard.values()))
    targets, joints = heard["path/targets"][0], heard["path/joint_states"][0]
    assert targets.accepted
    assert list(joints.position) == list(targets.targets[0].joint_positions)
    assert heard["robot_description"][0].data == load_robot(load_layout().robot).urdf.read_text()


def test_what_a_door_before_left_to_be_seen_is_taken_away_when_the_next_begins(running: Generator) -> None:
    shown = (topics.PATH_MARKERS, topics.PATH_NOMINAL, topics.PATH_CORRECTED)
    markers, nominal, corrected = (running.hear(t.type, t.name, t.requested) for t in shown)
    running.generate()
    running.wait(lambda: markers and nominal and corrected)
    assert len(markers[-1].markers) == 5
    running.generate("r2", found=False)
    running.wait(lambda: len(markers) > 1 and len(nominal) > 1 and len(corrected) > 1)
    assert [marker.action for marker in markers[-1].markers] == [Marker.DELETEALL]
    assert not nominal[-1].poses
    assert not corrected[-1].poses
    running.generate("r3")
    running.wait(lambda: len(markers[-1].markers) == 5)


ROBOT_FRAMES = {"flange", "tool", *(f"link_{n}" for n in range(1, 7))}


def chain(transforms: Iterable[Any]) -> dict[str, tuple[str, np.ndarray]]:
    """Parent and T_parent_child, shape (4, 4), by child: the latest of each."""
    frames = {}
    for t in transforms:
        p, q = t.transform.translation, t.transform.rotation
        matrix = from_xyzw(np.array([p.x, p.y, p.z]), np.array([q.x, q.y, q.z, q.w]))
        frames[t.child_frame_id] = (t.header.frame_id, matrix)
    return frames


def in_base(frames: dict[str, tuple[str, np.ndarray]], frame: str) -> np.ndarray:
    """T_base_frame, shape (4, 4)."""
    if frame == "base_link":
        return np.eye(4)
    parent, T_parent_frame = frames[frame]
    return in_base(frames, parent) @ T_parent_frame


PACKAGE = """<package format="3"><name>tf2_msgs</name><version>0.0.1</version><description>-</description>
<maintainer email="nobody@example.org">nobody</maintainer><license>-</license>
<buildtool_depend>ament_cmake</buildtool_depend>
<buildtool_depend>rosidl_default_generators</buildtool_depend><depend>geometry_msgs</depend>
<member_of_group>rosidl_interface_packages</member_of_group>
<export><build_type>ament_cmake</build_type></export></package>"""
CMAKE = """cmake_minimum_required(VERSION 3.20)
project(tf2_msgs)
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
find_package(geometry_msgs REQUIRED)
rosidl_generate_interfaces(${PROJECT_NAME} "msg/TFMessage.msg" DEPENDENCIES geometry_msgs)
ament_package()"""


def python_path() -> str:
    """This tree before what is installed."""
    return os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])


def with_tf2(folder: Path) -> dict[str, str]:
    """An environment that has tf2's messages: as it is where they are installed, else they are built here."""
    environment = os.environ | {"PYTHONPATH": python_path()}
    if tf_message_class() is not TFMessage:
        return environment
    source = folder / "src" / "tf2_msgs"
    (source / "msg").mkdir(parents=True)
    (source / "msg" / "TFMessage.msg").write_text("geometry_msgs/TransformStamped[] transforms\n")
    (source / "package.xml").write_text(PACKAGE)
    (source / "CMakeLists.txt").write_text(CMAKE)
    command = ["colcon", "build", "--merge-install", "--paths", str(source), "--cmake-args"]
    flags = ["-DBUILD_TESTING=OFF", f"-DPython3_EXECUTABLE={sys.executable}", "--no-warn-unused-cli"]
    done = subprocess.run(
        [*command, *flags], cwd=folder, capture_output=True, text=True, timeout=LIMIT, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    install = folder / "install"
    (packages,) = install.glob("lib/python3*/site-packages")
    before = {"AMENT_PREFIX_PATH": install, "LD_LIBRARY_PATH": install / "lib", "PYTHONPATH": packages}
    for name, path in before.items():
        environment[name] = os.pathsep.join([str(path), environment.get(name, "")])
    return environment


@pytest.mark.parametrize("installed", [False, True], ids=["as the wheels are", "with tf2"])
def test_the_bag_of_a_run_holds_every_frame_under_tf2_s_name(tmp_path: Path, installed: bool) -> None:
    environment = with_tf2(tmp_path) if installed else {**os.environ, "PYTHONPATH": python_path()}
    command = [
        sys.executable,
        "-m",
        "doormill_ros.tools.cell",
        "--door",
        DOOR,
        "--out",
        str(tmp_path / "run"),
    ]
    done = subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=LIMIT, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    bag = tmp_path / "run" / "bag"
    recorded = list(read_bag(bag, ["/tf", "/tf_static"]))
    assert {item.type_name for item in recorded} == {"tf2_msgs/msg/TFMessage"}
    frames = chain(t for item in recorded for t in item.message.transforms)
    latest = {item.topic: item.message for item in read_bag(bag, ["/door/localization", "/path/targets"])}

    door = transform_of(latest["/door/localization"].pose.pose)
    first = latest["/path/targets"].targets[0]
    assert np.abs(in_base(frames, "door") - door).max() < 1e-9
    assert np.abs(in_base(frames, "tool") - transform_of(first.corrected)).max() < 1e-6
    camera = load_camera().T_base_camera(shipped_recipes()[DOOR].width)
    assert np.abs(in_base(frames, "camera_optical_frame") - camera).max() < 1e-9
    assert set(frames) == ROBOT_FRAMES | {"door", "camera_optical_frame"}
