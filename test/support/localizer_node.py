"""The localizer's node that nobody spins: a test calls its callbacks and reads its answers."""

from __future__ import annotations

from typing import Any

from rclpy.context import Context
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message, serialize_message

from doormill_interfaces.msg import DoorLocalization
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.door_localizer import DoorLocalizer


def up(kind: type[ManagedNode], context: Context, **values: Any) -> Any:
    """An active node that nobody spins: the test calls its callbacks."""
    overrides = [Parameter(name, value=value) for name, value in values.items()]
    node = kind(context=context, parameter_overrides=overrides)
    node.trigger_configure()
    node.trigger_activate()
    assert node.active
    return node


class Answers(list[Any]):
    """Takes the place of a publisher."""

    publish = list.append


class Localizer:
    """A localizer with the recipe and the messages of a recorded run."""

    def __init__(self, recorded: dict[str, bytes], context: Context, **parameters: Any) -> None:
        self.node = up(DoorLocalizer, context, check_age=False, **parameters)
        self.node._teller._localization = self.answers = Answers()
        self.good = {
            topic.name: deserialize_message(recorded[f"/{topic.name}"], topic.type)
            for topic in (topics.DOOR_RECIPE, topics.CAMERA_INFO, topics.IMAGE)
        }
        self.send(topics.DOOR_RECIPE)

    def send(self, topic: topics.Topic, **changes: Any) -> None:
        message = deserialize_message(serialize_message(self.good[topic.name]), topic.type)
        for name, value in changes.items():
            setattr(message, name, value)
        (tap,) = (t for t in self.node.subscriptions if t.topic_name == f"/{topic.name}")
        tap.callback(message)

    def answer(self) -> DoorLocalization:
        before = len(self.answers)
        self.send(topics.IMAGE)
        assert len(self.answers) == before + 1
        return self.answers[-1]
