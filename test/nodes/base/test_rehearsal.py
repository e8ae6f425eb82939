"""Nodes do once what a door will ask for, before they are active, and nobody hears of it."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.node import Node
from rclpy.parameter import Parameter

from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.door_localizer import DoorLocalizer
from doormill_ros.nodes.path_generator import PathGenerator
from doormill_ros.nodes.recipe_database import RecipeDatabaseNode
from support.waiting import LIMIT

#: What each node tells of doors alone.
TOLD: list[tuple[Callable[..., ManagedNode], tuple[topics.Topic, ...]]] = [
    (DoorLocalizer, (topics.DOOR_POSE, topics.DOOR_LOCALIZATION, topics.DOOR_OVERLAY)),
    (PathGenerator, (topics.PATH_TARGETS, topics.PATH_NOMINAL, topics.PATH_MARKERS)),
    (RecipeDatabaseNode, (topics.DOOR_RECIPE,)),
    (AbbBridge, (topics.ABB_TARGET_FILE, topics.RUN_RESULT)),
]


def parameters_of(folder: Path) -> list[Parameter]:
    values = {
        "database_url": f"sqlite:///{folder / 'recipes.db'}",
        "address": str(folder),
        "archive": str(folder / "archive"),
    }
    return [Parameter(name, value=value) for name, value in values.items()]


@pytest.mark.parametrize(("make", "told"), TOLD, ids=lambda value: getattr(value, "__name__", ""))
def test_what_a_node_tells_first_is_not_its_rehearsal(
    make: Callable[..., ManagedNode],
    told: tuple[topics.Topic, ...],
    context: rclpy.Context,
    tmp_path: Path,
) -> None:
    node = make(context=context, parameter_overrides=parameters_of(tmp_path))
    listener = Node("listener", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(listener)
    heard: dict[str, list[tuple[int, int]]] = {topic.name: [] for topic in told}

    def listen(topic: topics.Topic) -> None:
        def hear(message: Any, info: Any) -> None:
            heard[topic.name].append((info["source_timestamp"], info["publication_sequence_number"]))

        listener.create_subscription(topic.type, topic.name, hear, topic.requested)

    for topic in told:
        listen(topic)
    assert node.trigger_configure() == TransitionCallbackReturn.SUCCESS
    node.rehearse()
    publishers = {publisher.topic_name.lstrip("/"): publisher for publisher in node.publishers}
    limit = time.monotonic() + LIMIT
    while any(publishers[topic.name].get_subscription_count() < 1 for topic in told):
        assert time.monotonic() < limit
        executor.spin_once(timeout_sec=0.05)
    now = time.time_ns()
    for topic in told:
        publishers[topic.name].publish(topic.type())
    while not all(any(sent >= now for sent, _ in messages) for messages in heard.values()):
        assert time.monotonic() < limit
        executor.spin_once(timeout_sec=0.05)
    # The publisher counts, also what nobody was there to hear.
    assert {number for messages in heard.values() for _, number in messages} == {1}
    executor.shutdown()
    node.close()
    node.destroy_node()
    listener.destroy_node()


class Player(ManagedNode):
    """Notes how it was when it rehearsed; breaks down while it does."""

    def __init__(self, context: rclpy.Context) -> None:
        super().__init__("player", context=context)
        self.rehearsed: list[tuple[bool, bool]] = []

    def rehearse(self) -> None:
        self.rehearsed.append((self.configured, self.active))
        raise ZeroDivisionError("nobody knows the text")


def test_a_node_rehearses_once_in_a_process_and_goes_on_where_that_fails(context: rclpy.Context) -> None:
    first, second = Player(context), Player(context)
    for node in (first, second):
        assert node.trigger_configure() == TransitionCallbackReturn.SUCCESS
        assert node.trigger_activate() == TransitionCallbackReturn.SUCCESS
        assert node.active
        node.destroy_node()
    assert first.rehearsed == [(False, False)]
    assert second.rehearsed == []
