"""Who gets nothing of a topic is named, once, and rclpy's events for that are not there."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Bool, String

from doormill_interfaces.action import MillDoor
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.unmatched import UnmatchedEndpoints
from support.waiting import LIMIT

LESS = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Asking(ManagedNode):
    """Takes one topic and offers another."""

    def __init__(self) -> None:
        super().__init__("asking")

    def setup(self) -> None:
        self.subscribe(topics.DOOR_LOCALIZATION, lambda _: None)
        self.publisher(topics.DOOR_OVERLAY)


@pytest.fixture
def asking() -> Iterator[Asking]:
    rclpy.init()
    node = Asking()
    try:
        node.trigger_configure()
        yield node
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


@pytest.fixture
def other() -> Iterator[Node]:
    """As another process: to itself DDS refuses one topic of two types."""
    context = rclpy.Context()
    rclpy.init(context=context)
    node = Node("other", namespace="/elsewhere", context=context)
    yield node
    node.destroy_node()
    rclpy.shutdown(context=context)


def heard(unmatched: UnmatchedEndpoints, found: Callable[[list[str]], bool]) -> list[str]:
    """What is told until it is enough."""
    told: list[str] = []
    deadline = time.monotonic() + LIMIT
    while not found(told):
        assert time.monotonic() < deadline, told
        told += unmatched.news()
        time.sleep(0.05)
    return told


def test_an_offer_that_is_too_little_is_named_once(asking: Asking, other: Node) -> None:
    topic = topics.DOOR_LOCALIZATION
    other.create_publisher(topic.type, f"/{topic.name}", LESS)
    unmatched = UnmatchedEndpoints(asking)
    (told,) = heard(unmatched, bool)
    assert told.startswith(f"/elsewhere/other publishes /{topic.name}, and nothing of it arrives here: ")
    assert ": Best effort publisher and reliable subscription; correct the offer" in told
    assert unmatched.news() == []


def test_a_request_for_more_than_is_offered_is_named(asking: Asking, other: Node) -> None:
    topic = topics.DOOR_OVERLAY
    other.create_subscription(topic.type, f"/{topic.name}", lambda _: None, LATCHED)
    (told,) = heard(UnmatchedEndpoints(asking), bool)
    assert told.startswith(
        f"/elsewhere/other subscribes to /{topic.name}, and nothing from here arrives there: "
    )
    assert told.endswith(": Volatile publisher and transient local subscription; correct the request")


@pytest.mark.parametrize("kind", [Bool, String])
def test_another_type_is_named(asking: Asking, other: Node, kind: Any) -> None:
    topic = topics.DOOR_LOCALIZATION
    other.create_publisher(kind, f"/{topic.name}", 10)
    (told,) = heard(UnmatchedEndpoints(asking), bool)
    assert (
        f"its type is std_msgs/msg/{kind.__name__}, this one has doormill_interfaces/msg/DoorLocalization"
        in told
    )


def test_what_fits_is_not_told_of(asking: Asking, other: Node) -> None:
    taken, offered, badly = topics.DOOR_LOCALIZATION, topics.DOOR_OVERLAY, topics.DIAGNOSTICS
    other.create_publisher(taken.type, f"/{taken.name}", taken.offered)
    other.create_subscription(offered.type, f"/{offered.name}", lambda _: None, LESS)
    other.create_subscription(badly.type, badly.name, lambda _: None, LATCHED)
    told = heard(UnmatchedEndpoints(asking), bool)
    deadline = time.monotonic() + LIMIT
    while not (asking.count_publishers(f"/{taken.name}") and asking.count_subscribers(f"/{offered.name}")):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    told += UnmatchedEndpoints(asking).news()
    assert {badly.name in sentence for sentence in told} == {True}


def test_an_actions_feedback_of_the_right_type_is_not_told_of(asking: Asking, other: Node) -> None:
    """The type of its messages is no /msg/ one."""
    feedback, name = MillDoor.Impl.FeedbackMessage, "/mill_door/_action/feedback"
    asking.create_subscription(feedback, name, lambda _: None, 10)
    other.create_publisher(feedback, name, 10)
    deadline = time.monotonic() + LIMIT
    while not asking.count_publishers(name):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    # What comes after this was heard of later than the feedback's publisher.
    marked = topics.DOOR_LOCALIZATION
    other.create_publisher(Bool, f"/{marked.name}", 10)
    told = heard(UnmatchedEndpoints(asking), bool)
    assert [sentence for sentence in told if "feedback" in sentence] == []


def test_only_events_that_somebody_asks_for_are_looked_at(asking: Asking) -> None:
    """Each costs time whenever anything wakes the node."""
    endpoints = [*asking.publishers, *asking.subscriptions]
    assert len(endpoints) >= 4
    assert [endpoint.topic_name for endpoint in endpoints if endpoint.event_handlers] == []


def test_an_endpoint_that_is_destroyed_meanwhile_is_passed_over(
    asking: Asking, monkeypatch: pytest.MonkeyPatch
) -> None:
    gone = list(asking.subscriptions)
    asking.trigger_cleanup()
    monkeypatch.setattr(Asking, "subscriptions", property(lambda _: gone))
    assert UnmatchedEndpoints(asking).news() == []


def test_what_is_taken_by_a_lesser_request_is_not_told_of(asking: Asking, other: Node) -> None:
    topic = topics.DOOR_LOCALIZATION
    other.create_publisher(topic.type, f"/{topic.name}", LESS)
    heard(UnmatchedEndpoints(asking), bool)
    asking.create_subscription(topic.type, topic.name, lambda _: None, LESS)
    assert UnmatchedEndpoints(asking).news() == []
