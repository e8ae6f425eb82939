"""The launch file under ROS' own launch: every node, a door, a node that dies, an end that leaves nothing behind."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import yaml

from doormill_ros.nodes.base import topics
from support.cell_processes import MANAGED, NODES, PATIENT, CellProcesses, free_port
from support.source_tree import ROOT
from support.waiting import LIMIT

DOOR = "thesis_190_0deg"
STARTED = re.compile(r"\[(\w+)-\d+\]: process started with pid \[(\d+)\]")


class LaunchedCell(CellProcesses):
    """The nodes of the launch file; its process is the only one that is ours."""

    robots = 1
    door_sensors = False

    def start(self, name: str) -> None:
        """All at once, with the first."""
        if self.processes:
            return
        self.page_port = free_port()
        self.launch("launch", out=self.folder / "out", page_port=self.page_port)

    def launch(self, process: str, **chosen: object) -> None:
        """Call the launch file, with these arguments beside those of the class."""
        parameters = self.folder / "parameters.yaml"
        parameters.write_text(yaml.safe_dump({"/**/abb_bridge": {"ros__parameters": PATIENT}}))
        arguments = {
            "parameters": parameters,
            "robots": self.robots,
            "door_sensors": self.door_sensors,
            **chosen,
        }
        command = [sys.executable, "-m", "support.launching", str(ROOT / "launch" / "cell.launch.py")]
        with open(self.folder / f"{process}.log", "wb") as log:
            self.processes[process] = subprocess.Popen(
                [*command, *(f"{key}:={value}" for key, value in arguments.items())],
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                env={**os.environ, "PYTHONPATH": f"{ROOT / 'test'}:{os.environ.get('PYTHONPATH', '')}"},
            )

    def interrupt(self) -> int:
        """As a terminal does: everything in it hears of it."""
        process = self.processes.pop("launch")
        os.killpg(process.pid, signal.SIGINT)
        return process.wait(LIMIT)

    def started(self, name: str) -> list[int]:
        """Process ids of a node, in the order of its starts."""
        return [int(pid) for node, pid in STARTED.findall(self.log("launch")) if node == name]


class LaunchedPair(LaunchedCell):
    """Two robots at one door."""

    robots = 2

    def wait_until_up(self) -> None:
        """Database, camera and localizer, then both robots and who shares the door between them."""
        names = (
            "bag_recorder",
            "recipe_database",
            "door_localizer",
            "camera_simulator",
            "door_shares",
            "operator_page",
        )
        of_robots = ("path_generator", "abb_bridge", "controller_simulator")
        for node in (*names, *(f"robot{number}/{name}" for number in (1, 2) for name in of_robots)):
            self.wait_until_active(node)


class CellsApart(LaunchedCell):
    """Two cells in one domain, each by a call of its own."""

    names = ("cell1", "cell2")

    def start(self, name: str) -> None:
        """Both at once, with the first."""
        for each in () if self.processes else self.names:
            self.launch(each, namespace=f"/{each}", out=self.folder / each, page_port=free_port())

    def wait_until_up(self) -> None:
        """Every node of both."""
        for each in self.names:
            for node in MANAGED:
                self.wait_until_active(f"{each}/{node}")


class SensingCell(LaunchedCell):
    """The other sensors beside the camera."""

    door_sensors = True


@pytest.fixture
def cell(tmp_path: Path) -> Iterator[LaunchedCell]:
    with LaunchedCell(tmp_path, nodes=NODES) as running:
        yield running


def test_it_mills_revives_what_dies_and_ends(cell: LaunchedCell) -> None:
    result, _ = cell.mill(DOOR)
    assert result.success, result.message
    (first,) = cell.started("path_generator")
    os.kill(first, signal.SIGKILL)
    cell.wait(lambda: len(cell.started("path_generator")) == 2)
    cell.wait_until_up()
    result, _ = cell.mill(DOOR)
    assert result.success, result.message
    assert (cell.folder / "out" / "targets").is_dir()
    pids = [int(pid) for _, pid in STARTED.findall(cell.log("launch"))]
    assert cell.interrupt() == 0
    said = (cell.folder / "launch.log").read_text()
    assert "escalating" not in said
    errors = [line for line in said.splitlines() if "[ERROR]" in line]
    assert [f"process has died [pid {first}" in line for line in errors] == [True], errors
    assert not [pid for pid in pids if Path(f"/proc/{pid}").exists()]


def test_the_other_sensors_are_beside_the_camera_and_at_rest(tmp_path: Path) -> None:
    with SensingCell(tmp_path, nodes=NODES) as cell:
        assert len(cell.started("door_sensors")) == 1
        told = cell.subscribe(topics.DIAGNOSTICS)
        for node in ("axis_vision", "photoelectric", "touch_probe"):
            cell.wait_until_active(node)
            said = cell.wait(lambda name=node: [s.message for m in told for s in m.status if s.name == name])
            assert said[-1].startswith("at rest: doors are found by camera")
        result, _ = cell.mill(DOOR)
        assert result.success, result.message


def test_two_cells_beside_each_other_share_nothing(tmp_path: Path) -> None:
    with CellsApart(tmp_path, nodes=("cell1",)) as cell:
        told = [cell.subscribe(topics.at(topics.RUN_RESULT, f"/{name}")) for name in cell.names]
        asked = [cell.subscribe(topics.at(topics.DOOR_RECIPE, f"/{name}")) for name in cell.names]
        results = [cell.mill(DOOR, action=f"/{name}/mill_door")[0] for name in cell.names]
        assert [result.success for result in results] == [True, True]
        # What the second heard of the first one's goal it has told by the end of its own.
        cell.wait(lambda: all(told) and all(asked))
        for name, result, ended, recipes in zip(cell.names, results, told, asked, strict=True):
            assert {message.run_id for message in ended} == {result.run_id}
            assert {message.run_id for message in recipes} == {result.run_id}
            assert {path.stem for path in (tmp_path / name / "targets").glob("*.txt")} == {result.run_id}


def test_two_robots_share_a_door(tmp_path: Path) -> None:
    with LaunchedPair(tmp_path, nodes=("launch",)) as cell:
        result, _ = cell.mill("standard_door")
        assert result.success, result.message
        for robot in ("robot1", "robot2"):
            assert list((tmp_path / "out" / "targets" / robot).glob("*.txt"))
        told = httpx.get(f"http://127.0.0.1:{cell.page_port}/state", timeout=LIMIT).json()
        assert [robot["present"] for robot in told["robots"]] == [True, True]
        assert [run["run_id"] for run in told["history"]] == [result.run_id]
        assert cell.interrupt() == 0
