"""When a node counts as dead: a late sign of life is no death, a missing one is named within two seconds."""

from __future__ import annotations

import signal
import subprocess
from types import SimpleNamespace

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor

from doormill_ros.nodes.base.alive import GRACE, LEASE, AliveWatch
from doormill_ros.nodes.base.managed_node import ManagedNode
from support.cell_processes import executable


class Watched:
    """A watch whose clock and whose DDS are the test's."""

    def __init__(self, node: ManagedNode) -> None:
        self.now = 100.0
        self.watch = AliveWatch(node, ("path_generator",), lambda: None, lambda: self.now)

    def heard(self, alive: int) -> None:
        self.watch._count("path_generator", SimpleNamespace(alive_count=alive))

    @property
    def dead(self) -> str:
        return self.watch.dead(("path_generator",))


@pytest.fixture
def watched(context: rclpy.Context):
    node = ManagedNode("bridge", context=context)
    yield Watched(node)
    node.destroy_node()


def test_a_node_that_was_never_there_is_not_dead(watched: Watched) -> None:
    watched.now += 100.0
    assert watched.dead == ""


def test_a_late_sign_of_life_is_no_death(watched: Watched) -> None:
    watched.heard(1)
    for _ in range(3):
        watched.heard(0)
        watched.now += 0.9 * GRACE
        assert watched.dead == ""
        watched.heard(1)
        watched.now += 10.0
        assert watched.dead == ""


def test_a_missing_one_is_and_in_time(watched: Watched) -> None:
    watched.heard(1)
    watched.heard(0)
    watched.now += GRACE
    watched.heard(0)  # said again, it is no news
    assert watched.dead == "path_generator"
    assert LEASE + GRACE < 2.0
    watched.heard(1)
    assert watched.dead == ""


def test_who_asks_for_a_longer_lease_gets_it(context: rclpy.Context) -> None:
    bridge = ManagedNode("bridge", context=context)
    watches = [
        AliveWatch(bridge, ("recipe_database",), lambda: None, lease=lease) for lease in (LEASE, 600.0)
    ]
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(bridge)
    with subprocess.Popen([executable("recipe_database")]) as other:
        try:
            while not all(watch.alive("recipe_database") for watch in watches):
                executor.spin_once(0.05)
            other.send_signal(signal.SIGSTOP)
            while watches[0].alive("recipe_database"):
                executor.spin_once(0.05)
            assert watches[1].alive("recipe_database")
        finally:
            other.kill()
    executor.shutdown()
    bridge.destroy_node()
