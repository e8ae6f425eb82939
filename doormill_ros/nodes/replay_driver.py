"""The node that drives a live replay: sends the goal and the pictures, hears the answers."""

from __future__ import annotations

import hashlib
import math
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.serialization import deserialize_message

from doormill_interfaces.action import MillDoor
from doormill_ros.cell.errors import StageTimeoutError
from doormill_ros.localization.errors import StalePicture
from doormill_ros.nodes import topics
from doormill_ros.nodes.convert.geometry import nanoseconds_of
from doormill_ros.recording.replay.answer import Answer, target_file_answer
from doormill_ros.recording.replay.recorded_run import (
    RecordedRun,
    localization_of,
    recipe_of,
    result_answer,
    targets_of,
)

START_LIMIT = 60.0  # s
ANSWER_LIMIT = 120.0  # s
MILLING_LIMIT = 3600.0  # s
AGAIN = 2.0  # s after which a picture that the bridge was not waiting for yet is sent once more
WAITING = ("", "recipe", "picture")  #: stages of the action before a picture was taken


class ReplayDriver(Node):
    """Plays who asks for a door, and its camera.

    Args:
        run: What is repeated.
        rate: Times the recorded speed; infinite to wait for answers only.
        to_the_end: Wait for the end of the run; otherwise cancel it when the stages have answered.
    """

    def __init__(self, run: RecordedRun, rate: float, to_the_end: bool) -> None:
        super().__init__("live_replay")
        self._run = run
        self._rate = rate
        self._to_the_end = to_the_end
        self._changed = threading.Condition()
        self._heard: dict[tuple[str, int], Any] = {}
        self._latest: dict[str, Any] = {}
        self._stage = ""
        self._result: Any = None
        self._action = ActionClient(self, MillDoor, "mill_door")
        self._image, self._info = (
            self.create_publisher(t.type, t.name, t.offered) for t in (topics.IMAGE, topics.CAMERA_INFO)
        )
        for topic in (topics.DOOR_LOCALIZATION, topics.PATH_TARGETS):
            self._listen(
                topic, lambda m, name=topic.name: self._keep((name, nanoseconds_of(m.header.stamp)), m)
            )
        for topic in (topics.DOOR_RECIPE, topics.ABB_STATUS, topics.ABB_TARGET_FILE):
            self._listen(topic, lambda m, name=topic.name: self._keep_latest(name, m))

    def destroy_node(self) -> None:
        """The action's client is not destroyed with its node."""
        self._action.destroy()
        super().destroy_node()

    def replay(self, begin: Callable[[], None], check_age: Callable[[bool], None]) -> list[Answer]:
        """Repeat the run.

        Args:
            begin: Called when the recipe is in hand; starts the controller.
            check_age: Called with True before a picture that was refused for its age, with False after it.

        Raises:
            StageTimeoutError: A node does not answer.
        """
        self._wait(self._connected, START_LIMIT, "the nodes did not come up")
        goal = self._start()
        recipe = topics.DOOR_RECIPE.name
        self._wait(lambda: recipe in self._latest or self._result, ANSWER_LIMIT, "the goal was not answered")
        answers = []
        if recipe in self._latest:
            answers.append(recipe_of(self._latest[recipe]))
            begin()
        if self._run.recipe is not None and recipe in self._latest:
            answers += self._pictures(check_age)
        answers += self._end(goal)
        return answers

    def _start(self) -> Any:
        sent: list[Any] = []

        def accepted(future: Any) -> None:
            future.result().get_result_async().add_done_callback(self._ended)
            self._notify(lambda: sent.append(future.result()))

        goal = MillDoor.Goal(door_id=self._run.door_id)
        self._action.send_goal_async(goal, self._feedback).add_done_callback(accepted)
        self._wait(lambda: sent, ANSWER_LIMIT, "the goal was not taken")
        return sent[0]

    def _pictures(self, check_age: Callable[[bool], None]) -> list[Answer]:
        """Send what was localized when it was recorded; what the stages answer."""
        run, answers = self._run, []
        last = nanoseconds_of(run.recipe.header.stamp)
        if any(level for _, level in run.requests):
            # A picture from before the request would not count for the run.
            self._wait(self._requested, MILLING_LIMIT, "the bridge saw no request")
        for recorded_ns, message in run.localizations:
            stamp_ns = nanoseconds_of(message.header.stamp)
            if stamp_ns not in run.pictures:
                continue
            if math.isfinite(self._rate):
                time.sleep(max(0, stamp_ns - last) * 1e-9 / self._rate)
            last = stamp_ns
            stale = message.error_code == StalePicture.code
            check_age(stale)
            age = (recorded_ns - stamp_ns) * 1e-9 - message.duration if stale else 0.0
            found = self._picture(stamp_ns, age)
            check_age(False)
            # A run takes the first picture of its request; that may have come before the bridge waited for it.
            while not answers and not stale and not self._taken():
                found = self._picture(stamp_ns, age)
            answers += [replace(answer, stamp_ns=stamp_ns) for answer in found]
        return answers

    def _picture(self, stamp_ns: int, age: float) -> list[Answer]:
        """Send one recorded picture under a new stamp; the answers to it."""
        now = time.time_ns() - int(age * 1e9)
        stamp = Time(sec=now // 1_000_000_000, nanosec=now % 1_000_000_000)
        for topic, publisher in ((topics.CAMERA_INFO, self._info), (topics.IMAGE, self._image)):
            data = self._run.serialized.get((topic.name, stamp_ns))
            if data is not None:
                message = deserialize_message(data, topic.type)
                message.header.stamp = stamp
                publisher.publish(message)
        localization = self._answer(topics.DOOR_LOCALIZATION, now)
        answers = [localization_of(localization)]
        if localization.accepted:
            answers.append(targets_of(self._answer(topics.PATH_TARGETS, now)))
        return answers

    def _taken(self) -> bool:
        """The run went on with a picture, or ended."""
        deadline = time.monotonic() + AGAIN
        with self._changed:
            while self._stage in WAITING and self._result is None and time.monotonic() < deadline:
                self._changed.wait(0.05)
            return self._stage not in WAITING or self._result is not None

    def _end(self, goal: Any) -> list[Answer]:
        """The target file and how the run ended."""
        run, answers = self._run, []
        handed_over = run.result is not None and bool(run.target_files or run.result.sha256)
        if self._to_the_end:
            self._wait(lambda: self._result is not None, MILLING_LIMIT, "the run did not end")
        name = topics.ABB_TARGET_FILE.name
        if handed_over:
            # It comes on another way than the result and may be heard after it.
            self._wait(
                lambda: name in self._latest or self._refused(), ANSWER_LIMIT, "no target file was written"
            )
        if handed_over and name in self._latest:
            answers.append(self._target_file())
        if self._to_the_end:
            end = self._result
            answers.append(result_answer(end.success, end.error_code, end.message))
        else:
            goal.cancel_goal_async()
            if run.result is not None:
                code = run.result.error_code
                answers.append(
                    replace(
                        result_answer(run.result.success, code, run.result.message),
                        not_compared=f"what ended the run (code {code}) cannot be repeated",
                    )
                )
        return answers

    def _refused(self) -> bool:
        """The run ended, and earlier or otherwise than when it was recorded."""
        end, recorded = self._result, self._run.result
        return end is not None and not end.success and end.error_code != recorded.error_code

    def _target_file(self) -> Answer:
        """The file that the bridge wrote, under the recorded run's name."""
        run_id = self._latest[topics.DOOR_RECIPE.name].run_id
        text = self._latest[topics.ABB_TARGET_FILE.name].data.replace(run_id, self._run.run_id)
        data = text.encode("ascii")
        accepted = next(m for m in self._run.targets if m.accepted)
        content = data if self._run.target_files else b""
        return target_file_answer(
            nanoseconds_of(accepted.header.stamp), content, hashlib.sha256(data).hexdigest()
        )

    def _connected(self) -> bool:
        """Every picture has its listener, every answer its speaker, the goal its server."""
        heard = (self._image.get_subscription_count(), self._info.get_subscription_count())
        spoken = [
            self.count_publishers(topic.name)
            for topic in (topics.DOOR_RECIPE, topics.DOOR_LOCALIZATION, topics.PATH_TARGETS, topics.DOOR_POSE)
        ]
        return min(*heard, *spoken) >= 1 and self._action.server_is_ready()

    def _requested(self) -> bool:
        status = self._latest.get(topics.ABB_STATUS.name)
        return (status is not None and status.request) or self._result is not None

    def _answer(self, topic: topics.Topic, stamp_ns: int) -> Any:
        key = topic.name, stamp_ns
        self._wait(lambda: key in self._heard, ANSWER_LIMIT, f"no message came on {topic.name}")
        return self._heard[key]

    def _listen(self, topic: topics.Topic, callback: Callable[[Any], None]) -> None:
        self.create_subscription(topic.type, topic.name, callback, topic.requested)

    def _keep(self, key: tuple[str, int], message: Any) -> None:
        self._notify(lambda: self._heard.__setitem__(key, message))

    def _keep_latest(self, name: str, message: Any) -> None:
        self._notify(lambda: self._latest.__setitem__(name, message))

    def _feedback(self, message: Any) -> None:
        self._notify(lambda: setattr(self, "_stage", message.feedback.stage))

    def _ended(self, future: Any) -> None:
        self._notify(lambda: setattr(self, "_result", future.result().result))

    def _notify(self, change: Callable[[], Any]) -> None:
        with self._changed:
            change()
            self._changed.notify_all()

    def _wait(self, condition: Callable[[], Any], limit: float, otherwise: str) -> None:
        deadline = time.monotonic() + limit
        with self._changed:
            while not condition():
                if time.monotonic() > deadline:
                    raise StageTimeoutError(f"live replay: {otherwise} (waited {limit:g} s)", limit=limit)
                self._changed.wait(0.05)
