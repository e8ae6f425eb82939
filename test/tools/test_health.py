"""The command that says whether the cell is ready, on nodes that run as processes."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
from pathlib import Path

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from doormill_ros.nodes.base import topics
from support.cell_processes import CellProcesses, executable
from support.waiting import LIMIT, until


def health(*arguments: str) -> tuple[int, str]:
    done = subprocess.run(
        [executable("health"), *arguments],
        capture_output=True,
        text=True,
        timeout=LIMIT,
        env=dict(os.environ),
    )
    assert "Traceback" not in done.stderr
    return done.returncode, done.stdout


def ready(cell: CellProcesses) -> None:
    """It becomes so; a node that ends to be started again is started by whoever waits, as a launch file does."""
    told: list[tuple[int, str]] = []

    def is_ready() -> bool:
        told.append(health("--wait", "8"))
        return told[-1] == (0, "ready\n")

    try:
        cell.wait(is_ready)
    except AssertionError as error:
        raise AssertionError(f"{told[-1]}; {error}") from None


def test_a_running_cell_is_ready_until_a_node_is_killed(tmp_path: Path) -> None:
    status, said = health("--wait", "1")
    assert status == 1
    assert "abb_bridge: not heard of" in said
    with CellProcesses(tmp_path) as cell:
        ready(cell)
        assert health("--wait", "1", "--namespace", "/cell2")[0] == 1
        cell.stop("path_generator", signal.SIGKILL)
        status, said = health("--wait", "0")
        assert status == 1
        # On a busy machine the others may be silent for a while; only the one that was killed is for ever.
        only = (1, "not ready\n  path_generator: not heard of for 3 s; start it\n")
        told: list[tuple[int, str]] = []

        def is_the_only_one() -> bool:
            told.append(health("--wait", "8"))
            return told[-1] == only

        until(is_the_only_one, lambda: told[-1])
        cell.start("path_generator")
        ready(cell)


class TwoRobots:
    """The nodes of a cell with two robots, as far as they tell of themselves."""

    def __init__(self) -> None:
        own = [f"robot{number}/{name}" for number in (1, 2) for name in ("path_generator", "abb_bridge")]
        self.said = dict.fromkeys(
            ("recipe_database", "bag_recorder", "door_localizer", "door_shares", *own), (b"\0", "active")
        )

    def __enter__(self) -> TwoRobots:
        rclpy.init()
        self._node = Node("two_robots")
        self._told = self._node.create_publisher(
            topics.DIAGNOSTICS.type, topics.DIAGNOSTICS.name, topics.DIAGNOSTICS.offered
        )
        self._node.create_publisher(topics.IMAGE.type, topics.IMAGE.name, topics.IMAGE.offered)
        self._node.create_timer(0.1, self._tell)
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._executor.spin, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._executor.shutdown(timeout_sec=2.0)
        rclpy.try_shutdown()
        self._thread.join(2.0)

    def _tell(self) -> None:
        status = [
            DiagnosticStatus(name=name, level=level, message=message, hardware_id="doormill")
            for name, (level, message) in list(self.said.items())
        ]
        self._told.publish(DiagnosticArray(status=status))


def test_of_two_robots_each_must_be_there_and_take_files() -> None:
    with TwoRobots() as cell:
        assert health("--wait", "60", "--robots", "2") == (0, "ready\n")
        # Who does not say so looks for the nodes of one robot.
        status, said = health("--wait", "1")
        assert status == 1
        assert "  path_generator: not heard of" in said
        cell.said["robot2/abb_bridge/controller"] = b"\1", "it is in manual mode"
        status, said = health("--wait", "10", "--robots", "2")
        assert (status, said) == (1, "not ready\n  controller of robot2: it is in manual mode\n")
        del cell.said["robot2/abb_bridge/controller"], cell.said["robot1/path_generator"]
        status, said = health("--wait", "10", "--robots", "2")
        assert (status, said) == (1, "not ready\n  robot1/path_generator: not heard of for 3 s; start it\n")


def test_a_wrong_wait_is_refused() -> None:
    done = subprocess.run(
        [executable("health"), "--wait", "-1"], capture_output=True, text=True, timeout=LIMIT
    )
    assert done.returncode == 2
    assert done.stderr.startswith("health: argument --wait: found -1")
