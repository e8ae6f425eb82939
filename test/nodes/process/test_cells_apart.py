"""Cells beside each other in one network: in namespaces they share nothing, without they refuse to mill."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psycopg
import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from rclpy.parameter import Parameter

from doormill_interfaces.msg import TargetArray
from doormill_ros.abb import signals
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.cell.errors import (
    CellBusyError,
    NodeDeadError,
    NodeDoubledError,
    NodeInactiveError,
    RunCanceledError,
)
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.alive import alive_topic
from doormill_ros.nodes.bridge.attendance import FIRST
from doormill_ros.nodes.convert.program import program_into
from doormill_ros.nodes.process.spinning import SteadyExecutor
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recording.bag_reader import read_bag
from support.cell_processes import CellProcesses, executable, free_port
from support.postgres import running_server
from support.waiting import LIMIT

DOOR, OTHER_DOOR = "thesis_190_0deg", "thesis_1350_0deg"
DOUBLED = 809
#: Copy that the robot program keeps of the file of the door in hand (docs/controller-link.md).
CUT_FILE = "Hei2.cut"


def run_cells(tmp_path: Path, cells: dict[str, list[str]], variables: dict[str, str]) -> dict[str, int]:
    """Exit status of cells that run beside each other, each in a folder of its name.

    Args:
        tmp_path: For the folders.
        cells: Arguments by name.
        variables: Of the environment, for all of them.
    """
    processes = {}
    for name, arguments in cells.items():
        folder = tmp_path / name
        folder.mkdir()
        environment = {
            **os.environ,
            "XDG_DATA_HOME": str(folder / "data"),
            "ROS_LOG_DIR": str(folder / "ros"),
            **variables,
        }
        command = [executable("cell"), *arguments, "--out", "run"]
        with open(folder / "log.txt", "wb") as log:
            processes[name] = subprocess.Popen(command, cwd=folder, stdout=log, stderr=log, env=environment)
    return {name: process.wait(LIMIT) for name, process in processes.items()}


def summary_of(folder: Path) -> dict[str, Any]:
    """What a cell said of its run."""
    return dict(json.loads((folder / "run" / "summary.json").read_text()))


def test_cells_in_namespaces_of_their_own_share_nothing_but_a_database(tmp_path: Path) -> None:
    """Both begin with one empty PostgreSQL database, for recipes and for the catalogue of runs."""
    doors = {"cell1": DOOR, "cell2": OTHER_DOOR}
    arguments = {name: ["--namespace", f"/{name}", "--door", door] for name, door in doors.items()}
    with running_server() as server:
        url = server.empty_database()
        shared = {"DOORMILL_DATABASE": url, "DOORMILL_CATALOGUE": url}
        statuses = run_cells(tmp_path, arguments, shared)
        with psycopg.connect(url) as connection:
            known = connection.execute("SELECT door_id FROM door").fetchall()
            runs = connection.execute("SELECT door_id FROM catalogue_run").fetchall()
    for name, door in doors.items():
        folder = tmp_path / name
        assert statuses[name] == 0, (folder / "log.txt").read_text()
        summary = summary_of(folder)
        assert (summary["door_id"], summary["outcome"]) == (door, "milled")
        (file,) = files_at_controller(folder)
        assert f"#door {door}\n" in file.read_text("ascii")
        found = {message.topic for message in read_bag(folder / "run" / "bag")}
        assert f"/{name}/run/result" in found
        assert {topic for topic in found if not topic.startswith(f"/{name}/")} <= {
            "/rosout",
            "/parameter_events",
        }
        assert [*(folder / "data").rglob("*.sqlite")] == []
    assert {DOOR, OTHER_DOOR} <= {door for (door,) in known}
    assert sorted(door for (door,) in runs) == sorted(doors.values())


#: What a bridge says beside another one; which depends on who was first: doubled, dead once the other one has ended,
#: canceled by its end, or answered by its bridge, which has the other door in hand or is not active any more.
REFUSED = (NodeDoubledError, NodeDeadError, RunCanceledError, CellBusyError, NodeInactiveError)


def files_at_controller(folder: Path) -> list[Path]:
    """Target files that a cell's controller holds, and the one that it milled last."""
    home = folder / "run" / "controller" / "HOME"
    return [path for name in (signals.TARGET_FILE, CUT_FILE) if (path := home / name).exists()]


def test_two_cells_without_namespaces_refuse_or_mill_the_door_that_was_asked_for(tmp_path: Path) -> None:
    """What one cell sees would be taken for another's: neither may mill the other one's door."""
    doors = {"one": DOOR, "other": OTHER_DOOR}
    statuses = run_cells(tmp_path, {name: ["--door", door] for name, door in doors.items()}, {})
    for name, door in doors.items():
        log = (tmp_path / name / "log.txt").read_text()
        summary = summary_of(tmp_path / name)
        files = [path.read_text("ascii") for path in files_at_controller(tmp_path / name)]
        assert {line for text in files for line in text.splitlines() if line.startswith("#door ")} <= {
            f"#door {door}"
        }, log
        if statuses[name] == 0:
            assert summary["outcome"] == "milled", log
            assert files, log
        else:
            assert statuses[name] == 1, log
            assert summary["error_code"] in [refusal.code for refusal in REFUSED], log
            assert summary["message"], log
        assert "Traceback" not in log


#: A goal that finds neither recipes nor a camera ends soon.
HASTY = {f"limit.{stage}": 1.0 for stage in ("recipe", "picture", "targets", "request")}


@contextmanager
def first(folder: Path, parameters: dict[str, dict[str, Any]]) -> Iterator[CellProcesses]:
    """A cell whose bridge has been alone long enough to be the first."""
    nodes = ("recipe_database", "door_localizer", "path_generator", "abb_bridge", "cell_simulator")
    with CellProcesses(folder / "cell", parameters, nodes) as running:
        running.wait(lambda: running.node.count_publishers(f"/{alive_topic(FIRST).name}"))
        yield running


class SecondBridge:
    """One more process of a bridge beside a cell."""

    def __init__(self, cell: CellProcesses, namespace: str, parameters: dict[str, Any]) -> None:
        self._cell = cell
        self._log = cell.folder / "second.log"
        values = {"archive": cell.folder / "second_targets", **HASTY, **parameters}
        command = [executable("abb_bridge"), "--ros-args", "-r", f"__ns:={namespace}"]
        command += [part for name, value in values.items() for part in ("-p", f"{name}:={value}")]
        with open(self._log, "wb") as log:
            self._process = subprocess.Popen(command, stdout=log, stderr=log)

    @property
    def log(self) -> str:
        return self._log.read_text(errors="replace")

    def __enter__(self) -> SecondBridge:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()

    def end(self) -> None:
        self._process.send_signal(signal.SIGINT)
        assert self._process.wait(LIMIT) == 0, self.log
        assert "Traceback" not in self.log
        assert "RCLError" not in self.log

    def gives_way(self) -> None:
        def said() -> bool:
            assert self._process.poll() is None, self.log
            return "gives way" in self.log

        self._cell.wait(said)


def _diagnosed(messages: list[DiagnosticArray], name: str) -> bool:
    """A node of that name says in diagnostics that it is one too many."""
    values = [v for m in messages for s in m.status if s.name == name for v in s.values]
    return any((v.key, v.value) == ("error_code", str(DOUBLED)) for v in values)


def test_a_second_bridge_of_one_name_leaves_the_goals_to_the_first(tmp_path: Path) -> None:
    home = tmp_path / "other_HOME"
    home.mkdir()
    with first(tmp_path, {}) as cell, SecondBridge(cell, "/", {"address": home}) as second:
        heard = cell.subscribe(topics.DIAGNOSTICS)
        second.gives_way()
        cell.wait(lambda: _diagnosed(heard, "abb_bridge"))
        for door in (DOOR, OTHER_DOOR, DOOR):
            result, _ = cell.mill(door)
            assert result.success, result.message
        assert not list((cell.folder / "second_targets").glob("*"))
        second.end()
        assert cell.mill(OTHER_DOOR)[0].success


def test_a_second_bridge_on_one_controller_refuses_and_takes_over_from_the_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DOORMILL_CONTROLLER_USER", "Default User")
    monkeypatch.setenv("DOORMILL_CONTROLLER_PASSWORD", "robotics")
    port = free_port()
    link = {"transport": "rws1", "address": f"http://127.0.0.1:{port}"}
    served = {"controller_simulator:web_services": "rws1", "controller_simulator:web_services_port": port}
    parameters = {"abb_bridge": link, "cell_simulator": served}
    other_way = {**link, "address": f"http://localhost:{port}/"}
    with first(tmp_path, parameters) as cell, SecondBridge(cell, "/cell2", other_way) as second:
        second.gives_way()
        refused, _ = cell.mill(DOOR, action="/cell2/mill_door")
        assert refused.error_code == DOUBLED, refused.message
        assert "another bridge" in refused.message
        result, _ = cell.mill(DOOR)
        assert result.success, result.message
        cell.stop("abb_bridge", signal.SIGKILL)
        cell.wait(lambda: cell.mill(DOOR, action="/cell2/mill_door")[0].error_code != DOUBLED)
        second.end()


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
        self.executor = SteadyExecutor(2, context=context)
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
