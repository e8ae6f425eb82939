"""What only people look at is done later, once, and not after clean-up."""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import TransitionCallbackReturn

from doormill_ros.nodes.base.managed_node import ManagedNode
from support.waiting import LIMIT


class Shower(ManagedNode):
    """Notes what it shows."""

    def __init__(self, context: rclpy.Context) -> None:
        super().__init__("shower", context=context)
        self.shown: list[str] = []

    def show(self, name: str, what: str) -> None:
        self.later(name, lambda: self.shown.append(what))


@pytest.fixture
def running() -> Iterator[tuple[Shower, SingleThreadedExecutor]]:
    context = rclpy.Context()
    rclpy.init(context=context)
    node = Shower(context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    assert node.trigger_configure() == TransitionCallbackReturn.SUCCESS
    assert node.trigger_activate() == TransitionCallbackReturn.SUCCESS
    yield node, executor
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown(context=context)


def spin_until_shown(node: Shower, executor: SingleThreadedExecutor, count: int) -> None:
    limit = time.monotonic() + LIMIT
    while len(node.shown) < count:
        assert time.monotonic() < limit
        executor.spin_once(timeout_sec=0.05)


def test_the_latest_is_shown_once_and_not_at_once(running: tuple[Shower, SingleThreadedExecutor]) -> None:
    node, executor = running
    node.show("path", "first path")
    node.show("path", "second path")
    node.show("overlay", "overlay")
    assert node.shown == []
    spin_until_shown(node, executor, 2)
    node.show("path", "third path")
    spin_until_shown(node, executor, 3)
    assert sorted(node.shown[:2]) == ["overlay", "second path"]
    assert node.shown[2:] == ["third path"]


def test_doors_leave_nothing_behind(running: tuple[Shower, SingleThreadedExecutor]) -> None:
    """A callback group keeps a reference to every timer that was ever made in it."""
    node, executor = running
    node.show("path", "first path")
    spin_until_shown(node, executor, 1)
    before = len(node.default_callback_group.entities)
    for number in range(5):
        node.show("path", f"path {number}")
        spin_until_shown(node, executor, 2 + number)
    assert len(node.default_callback_group.entities) == before


def test_nothing_is_shown_after_clean_up(running: tuple[Shower, SingleThreadedExecutor]) -> None:
    node, executor = running
    node.show("path", "path")
    node.trigger_deactivate()
    node.trigger_cleanup()
    node.trigger_configure()
    node.trigger_activate()
    node.show("marker", "what comes next")
    spin_until_shown(node, executor, 1)
    assert node.shown == ["what comes next"]


def test_what_goes_wrong_is_reported_and_the_node_lives_on(
    running: tuple[Shower, SingleThreadedExecutor],
) -> None:
    node, executor = running
    node.later("overlay", lambda: 1 / 0)
    node.show("path", "path")
    limit = time.monotonic() + LIMIT
    while "division" not in node._health[1] or not node.shown:
        assert time.monotonic() < limit
        executor.spin_once(timeout_sec=0.05)
    assert node.shown == ["path"]
