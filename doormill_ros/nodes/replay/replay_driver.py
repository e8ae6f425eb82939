"""The node that drives a live replay: sends the goal and the pictures, hears the answers."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, TypeVar

from builtin_interfaces.msg import Time
from rclpy.node import Node
from rclpy.serialization import deserialize_message

from doormill_interfaces.action import MillDoor
from doormill_ros.cell.places.layout import CAMERA
from doormill_ros.cell.run.waiting import wait, wait_until
from doormill_ros.messages.stamps import nanoseconds_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.clients.goal_client import GoalClient
from doormill_ros.units import s_to_ns

START_LIMIT = 60.0  # s
ANSWER_LIMIT = 120.0  # s
MILLING_LIMIT = 3600.0  # s
AGAIN = 2.0  # s after which a picture that the bridge was not waiting for yet is sent once more
WAITING = ("", "recipe", "picture")  #: stages of the action before a picture was taken

Value = TypeVar("Value")


class ReplayDriver(Node):  # type: ignore[misc]  # rclpy has no types
    """Plays who asks for a door, and its camera, as an `AnsweringCell` does."""

    def __init__(self, transport: str = "raw", sensors: Sequence[str] = (CAMERA,)) -> None:
        """Play the drivers of these sensors; send pictures the way that `image_transport` names so."""
        super().__init__("live_replay")
        self._changed = threading.Condition()
        self._heard: dict[tuple[str, int], Any] = {}
        self._latest: dict[str, Any] = {}
        self._stage = ""
        self._goal: Any = None
        self._result: Any = None
        self._action = GoalClient(self, MillDoor, "mill_door")
        self._pictures = {
            t.name: self.create_publisher(t.type, t.name, t.offered)
            for t in (
                *((topics.CAMERA_INFO, topics.PICTURES[transport]) if CAMERA in sensors else ()),
                *((topics.SENSOR_READING,) if tuple(sensors) != (CAMERA,) else ()),
            )
        }
        for topic in (topics.DOOR_LOCALIZATION, topics.PATH_TARGETS):
            self._listen(topic, partial(self._keep, topic.name))
        for topic in (topics.DOOR_RECIPE, topics.ABB_STATUS, topics.ABB_TARGET_FILE):
            self._listen(topic, partial(self._keep_latest, topic.name))

    def destroy_node(self) -> None:
        """The action's client is not destroyed with its node."""
        self._action.destroy()
        super().destroy_node()

    def send_goal(self, door_id: str) -> None:
        """See `AnsweringCell`."""
        self._wait(self._connected, START_LIMIT, "the nodes did not come up")
        goal = MillDoor.Goal(door_id=door_id)
        self._action.send_goal_async(goal, self._feedback).add_done_callback(self._accepted)
        self._wait(lambda: self._goal, ANSWER_LIMIT, "the goal was not taken")

    def cancel_goal(self) -> None:
        """See `AnsweringCell`."""
        self._goal.cancel_goal_async()

    def wait_for_recipe(self) -> Any:
        """See `AnsweringCell`."""
        name = topics.DOOR_RECIPE.name
        self._wait(
            lambda: name in self._latest or self._result is not None,
            ANSWER_LIMIT,
            "the goal was not answered",
        )
        return self._latest.get(name)

    def wait_for_request(self) -> None:
        """See `AnsweringCell`."""
        self._wait(self._requested, MILLING_LIMIT, "the bridge saw no request")

    def show_picture(self, data: Sequence[tuple[str, bytes]], age: float) -> tuple[Any, Any]:
        """See `AnsweringCell`."""
        now = time.time_ns() - s_to_ns(age)
        stamp = Time(sec=now // 1_000_000_000, nanosec=now % 1_000_000_000)
        for name, content in data:
            publisher = self._pictures[name]
            message = deserialize_message(content, publisher.msg_type)
            message.header.stamp = stamp
            if name == topics.SENSOR_READING.name:
                message.run_id = self._latest[topics.DOOR_RECIPE.name].run_id
            publisher.publish(message)
        localization = self._answer(topics.DOOR_LOCALIZATION, now)
        return localization, self._answer(topics.PATH_TARGETS, now) if localization.accepted else None

    def went_on(self) -> bool:
        """See `AnsweringCell`."""
        return bool(
            wait(self._changed, lambda: self._stage not in WAITING or self._result is not None, AGAIN)
        )

    def wait_for_result(self) -> Any:
        """See `AnsweringCell`."""
        return self._wait(lambda: self._result, MILLING_LIMIT, "the run did not end")

    def wait_for_target_file(self, unless: Callable[[Any], bool]) -> str | None:
        """See `AnsweringCell`."""
        name = topics.ABB_TARGET_FILE.name
        self._wait(
            lambda: name in self._latest or (self._result is not None and unless(self._result)),
            ANSWER_LIMIT,
            "no target file was written",
        )
        return str(self._latest[name].data) if name in self._latest else None

    def _connected(self) -> bool:
        """Every picture has its listener, every answer its speaker, the goal its server."""
        heard = [publisher.get_subscription_count() for publisher in self._pictures.values()]
        spoken = [
            self.count_publishers(topic.name)
            for topic in (topics.DOOR_RECIPE, topics.DOOR_LOCALIZATION, topics.PATH_TARGETS, topics.DOOR_POSE)
        ]
        return bool(min(*heard, *spoken) >= 1 and self._action.server_is_ready())

    def _requested(self) -> bool:
        status = self._latest.get(topics.ABB_STATUS.name)
        return (status is not None and bool(status.request)) or self._result is not None

    def _answer(self, topic: topics.Topic, stamp_ns: int) -> Any:
        key = topic.name, stamp_ns
        return self._wait(lambda: self._heard.get(key), ANSWER_LIMIT, f"no message came on {topic.name}")

    def _listen(self, topic: topics.Topic, callback: Callable[[Any], None]) -> None:
        self.create_subscription(topic.type, topic.name, callback, topic.requested)

    def _keep(self, name: str, message: Any) -> None:
        with self._changed:
            self._heard[name, nanoseconds_of(message.header.stamp)] = message
            self._changed.notify_all()

    def _keep_latest(self, name: str, message: Any) -> None:
        with self._changed:
            self._latest[name] = message
            self._changed.notify_all()

    def _feedback(self, message: Any) -> None:
        with self._changed:
            self._stage = message.feedback.stage
            self._changed.notify_all()

    def _accepted(self, future: Any) -> None:
        with self._changed:
            self._goal = future.result()
            self._changed.notify_all()
        self._goal.get_result_async().add_done_callback(self._ended)

    def _ended(self, future: Any) -> None:
        with self._changed:
            self._result = future.result().result
            self._changed.notify_all()

    def _wait(self, look: Callable[[], Value | None], limit: float, otherwise: str) -> Value:
        return wait_until(self._changed, look, limit, f"live replay: {otherwise}")
