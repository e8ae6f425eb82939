"""What no program can be faster than on this machine: DDS there and back, a flush to the disk, Robot Web Services.

Messages go out and come back serialized, between two processes that do nothing else.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import rclpy
from geometry_msgs.msg import PoseStamped
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from std_msgs.msg import Empty

from doormill_ros.abb.credentials import Credentials
from doormill_ros.abb.transports.rws import connect_rws1
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.nodes.base.topics import DOOR_POSE, IMAGE, PATH_TARGETS, Topic
from doormill_ros.nodes.convert.picture import picture_message
from doormill_ros.nodes.convert.program import program_into
from doormill_ros.nodes.process.dds_settings import make_room_for_pictures
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from doormill_ros.simulation.picture.scene import SceneCamera

TIMES = 60
LIMIT = 30.0  # s
BACK = QoSProfile(depth=10)
TOPICS = {"picture": IMAGE, "pose": DOOR_POSE, "targets": PATH_TARGETS}


def dds_round_trips(door: str) -> dict[str, float]:
    """Median time of a picture, a pose and a door's targets to another process, and an empty answer back [s]."""
    make_room_for_pictures()
    echo = subprocess.Popen([sys.executable, __file__])
    rclpy.init()
    try:
        return _round_trips(echo, _messages(door))
    finally:
        rclpy.try_shutdown()
        echo.terminate()
        echo.wait()


def _messages(door: str) -> dict[str, Any]:
    setup, recipe = load_setup(), load_recipe(door)
    T_base_door = load_layout().T_base_door(recipe.width, recipe.thickness)
    targets = program_into(PATH_TARGETS.type(), plan(recipe, T_base_door, setup).program)
    picture = picture_message(_grey(), targets.header)
    return {"picture": picture, "pose": PoseStamped(), "targets": targets}


def _grey() -> Any:
    import numpy as np

    return np.full(SceneCamera.load().shape, 128, dtype=np.uint8)


def _round_trips(echo: subprocess.Popen[bytes], messages: dict[str, Any]) -> dict[str, float]:
    node = Node("floor")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    heard: list[float] = []
    node.create_subscription(Empty, "floor/back", lambda _: heard.append(time.perf_counter()), BACK)
    medians = {}
    for name, topic in TOPICS.items():
        publisher = node.create_publisher(topic.type, f"floor/{name}", topic.offered)
        data = serialize_message(messages[name])
        _until(executor, lambda p=publisher: p.get_subscription_count(), echo)
        times: list[float] = []
        while len(times) < TIMES:
            heard.clear()
            begun = time.perf_counter()
            publisher.publish(data)
            _until(executor, lambda: heard, echo)
            times.append(heard[0] - begun)
        medians[name] = statistics.median(times)
    node.destroy_node()
    return medians


def _until(executor: SingleThreadedExecutor, condition: Any, echo: subprocess.Popen[bytes]) -> None:
    end = time.monotonic() + LIMIT
    while not condition():
        if time.monotonic() > end or echo.poll() is not None:
            raise TimeoutError("the process that answers does not")
        executor.spin_once(timeout_sec=0.1)


def _answer() -> None:
    """The other process."""
    rclpy.init()
    node = Node("floor_echo")
    back = node.create_publisher(Empty, "floor/back", BACK)

    def listen(name: str, topic: Topic) -> None:
        node.create_subscription(
            topic.type, f"floor/{name}", lambda _: back.publish(Empty()), topic.requested, raw=True
        )

    for name, topic in TOPICS.items():
        listen(name, topic)
    try:
        rclpy.spin(node)
    except Exception:
        rclpy.try_shutdown()


def disk_flush(folder: Path, size: int) -> float:
    """Median time to write a new file of a size and have it on the medium [s]."""
    times = []
    for number in range(TIMES):
        path = folder / f"flush{number}"
        begun = time.perf_counter()
        with path.open("wb") as file:
            file.write(b"x" * size)
            file.flush()
            os.fsync(file.fileno())
        times.append(time.perf_counter() - begun)
        path.unlink()
    return statistics.median(times)


def rws_round_trip() -> float:
    """Median time to ask a controller on this machine for one signal [s]."""
    with tempfile.TemporaryDirectory() as folder, RwsServer(Cabinet.create(Path(folder))) as server:
        link = connect_rws1(server.url, Credentials("Default User", "robotics"), subscribe=False)
        times = []
        for _ in range(TIMES):
            begun = time.perf_counter()
            link.read_ready()
            times.append(time.perf_counter() - begun)
        link.close()
    return statistics.median(times)


if __name__ == "__main__":
    _answer()
