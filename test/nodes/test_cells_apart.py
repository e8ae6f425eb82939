"""Cells beside each other in one network: in namespaces they share nothing, without they refuse to mill."""

from __future__ import annotations

import json
import os
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter

from doormill_interfaces.msg import TargetArray
from doormill_ros.abb import signals
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.cell.layout import load_layout
from doormill_ros.nodes import topics
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.convert.program import program_into
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recording.bag_reader import read_bag
from support.cell_processes import CellProcesses, executable

DOOR, OTHER_DOOR = "thesis_190_0deg", "thesis_1350_0deg"
DOUBLED = 809
LIMIT = 300.0  # s


def test_cells_in_namespaces_of_their_own_share_nothing(tmp_path: Path) -> None:
    cells = {"/cell1": DOOR, "/cell2": OTHER_DOOR}
    processes = []
    for namespace, door in cells.items():
        folder = tmp_path / namespace.strip("/")
        folder.mkdir()
        environment = {
            **os.environ,
            "XDG_DATA_HOME": str(folder / "data"),
            "ROS_LOG_DIR": str(folder / "ros"),
        }
        command = [executable("cell"), "--namespace", namespace, "--door", door, "--out", "run"]
        with open(folder / "log.txt", "wb") as log:
            processes.append(subprocess.Popen(command, cwd=folder, stdout=log, stderr=log, env=environment))
    statuses = [process.wait(LIMIT) for process in processes]
    for (namespace, door), status in zip(cells.items(), statuses, strict=True):
        folder = tmp_path / namespace.strip("/")
        assert status == 0, (folder / "log.txt").read_text()
        summary = json.loads((folder / "run" / "summary.json").read_text())
        assert (summary["door_id"], summary["outcome"]) == (door, "milled")
        found = {message.topic for message in read_bag(folder / "run" / "bag")}
        assert f"{namespace}/run/result" in found
        assert {topic for topic in found if not topic.startswith(f"{namespace}/")} <= {
            "/rosout",
            "/parameter_events",
        }


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CellProcesses]:
    nodes = ("recipe_database", "door_localizer", "path_generator", "abb_bridge", "cell_simulator")
    with CellProcesses(tmp_path_factory.mktemp("cell"), nodes=nodes) as running:
        yield running


def _refusal(cell: CellProcesses) -> str:
    result, _ = cell.mill(DOOR)
    assert not result.success
    assert result.error_code == DOUBLED, result.message
    assert not list((cell.folder / "targets").glob("*"))
    return str(result.message)


class Bridge:
    """A bridge on a controller that asks for a file, and a node beside it that sends targets."""

    def __init__(self, folder: Path, context: rclpy.Context) -> None:
        self.home, self.archive = folder / "HOME", folder / "targets"
        self.home.mkdir()
        parameters = {"address": str(self.home), "archive": str(self.archive)}
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        self.bridge = AbbBridge(context=context, parameter_overrides=overrides)
        self.node = Node("beside", context=context)
        topic = topics.PATH_TARGETS
        self.targets = self.node.create_publisher(topic.type, topic.name, topic.offered)
        self.executor = SingleThreadedExecutor(context=context)
        for node in (self.bridge, self.node):
            self.executor.add_node(node)
        self.thread = threading.Thread(target=self.executor.spin, daemon=True)
        self.thread.start()
        self.bridge.bring_up()
        (self.home / "io").mkdir(exist_ok=True)
        (self.home / "io" / signals.REQUEST).write_bytes(signals.HIGH)
        self.until(lambda: self.state == HandshakeState.REQUESTED)

    @property
    def state(self) -> HandshakeState:
        return self.bridge.handshake.snapshot.state

    def until(self, condition: Callable[[], object]) -> None:
        deadline = time.monotonic() + LIMIT
        while not condition():
            assert time.monotonic() < deadline, self.bridge.handshake.snapshot
            time.sleep(0.02)

    def close(self) -> None:
        self.bridge.close()
        self.executor.shutdown(timeout_sec=2.0)
        self.thread.join(2.0)
        self.bridge.destroy_node()
        self.node.destroy_node()


@pytest.fixture
def bridge(tmp_path: Path) -> Iterator[Bridge]:
    context = rclpy.Context()
    rclpy.init(context=context)
    running = Bridge(tmp_path, context)
    yield running
    running.close()
    rclpy.shutdown(context=context)


def test_targets_that_no_goal_of_this_bridge_asked_for_are_never_announced(bridge: Bridge) -> None:
    """Of a run before a restart of the bridge, or of another cell: another door may stand in the clamp."""
    recipe = shipped_recipes()[DOOR]
    T_base_door = load_layout().T_base_door(recipe.width, recipe.thickness)
    message = program_into(TargetArray(accepted=True), plan(recipe, T_base_door, load_setup()).program)
    message.run_id = "20200101T000000000000Z"
    message.header.stamp = bridge.node.get_clock().now().to_msg()
    bridge.until(lambda: bridge.targets.get_subscription_count() > 0)
    bridge.targets.publish(message)
    bridge.until(lambda: message.run_id in bridge.bridge._health[1])
    assert "left aside" in bridge.bridge._health[1]
    for _ in range(20):  # steps of the handshake
        bridge.bridge.handshake.wait(0.05)
    assert bridge.state == HandshakeState.REQUESTED
    assert not (bridge.home / signals.TARGET_FILE).exists()
    assert not list(bridge.archive.glob("*"))
