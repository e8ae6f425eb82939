"""Send a recorded run's inputs to the nodes over DDS and collect what they answer."""

from __future__ import annotations

import hashlib
import math
import os
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any

import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter

from doormill_ros.abb.target_file import render_target_file
from doormill_ros.cell.errors import StageTimeoutError
from doormill_ros.nodes import topics
from doormill_ros.nodes.convert.geometry import nanoseconds_of
from doormill_ros.nodes.convert.program import program_of
from doormill_ros.nodes.door_localizer import DoorLocalizer
from doormill_ros.nodes.path_generator import PathGenerator
from doormill_ros.nodes.run import init, shut_down
from doormill_ros.recording.replay.answer import (
    LOCALIZATION,
    TARGET_FILE,
    TARGETS,
    Answer,
    target_file_answer,
)
from doormill_ros.recording.replay.recorded_run import RecordedRun, localization_of, targets_of

LIVE_TOPICS = (LOCALIZATION, TARGETS, TARGET_FILE)
#: Targets follow from a pose found anew, whose own tolerance is that of a lever of some metres.
SLACK = 50.0
START_LIMIT = 30.0  # s
ANSWER_LIMIT = 60.0  # s
THREADS = 4


def _overrides(values: dict[str, Any]) -> list[Parameter]:
    return [Parameter(name, value=value) for name, value in values.items()]


class LiveReplay:
    """The localizer and the path generator in a namespace of their own; a context manager.

    Args:
        rate: Times the recorded speed; infinite to wait for answers only.
        robot_model: For the path generator; empty for the joint springs.
    """

    def __init__(self, rate: float = 1.0, robot_model: str = "") -> None:
        self._rate = rate
        self._model = robot_model
        self._heard: dict[tuple[str, str, int], Any] = {}
        self._changed = threading.Condition()

    def __enter__(self) -> LiveReplay:
        arguments = ["replay", "--ros-args", "-r", f"__ns:=/replay_{os.getpid()}"]
        init(arguments)
        # A recorded picture is old; an overlay nobody looks at costs time.
        localizer = {"check_age": False, "overlay_step": 0}
        self._nodes = [
            DoorLocalizer(parameter_overrides=_overrides(localizer)),
            PathGenerator(parameter_overrides=_overrides({"robot_model": self._model})),
        ]
        self._node = Node("live_replay")
        inputs = (topics.DOOR_RECIPE, topics.CAMERA_INFO, topics.IMAGE)
        self._publishers = {t.name: self._node.create_publisher(t.type, t.name, t.offered) for t in inputs}
        for topic in (topics.DOOR_LOCALIZATION, topics.PATH_TARGETS):
            self._node.create_subscription(
                topic.type, topic.name, self._listener(topic.name), topic.requested
            )
        self._executor = MultiThreadedExecutor(num_threads=THREADS)
        for node in (*self._nodes, self._node):
            self._executor.add_node(node)
        self._thread = threading.Thread(target=self._executor.spin, name="executor", daemon=True)
        self._thread.start()
        for node in self._nodes:
            node.bring_up()
        self._wait(self._connected, START_LIMIT, "the nodes did not come up")
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        shut_down(self._nodes)
        self._executor.shutdown(timeout_sec=2.0)
        rclpy.try_shutdown()
        self._thread.join(2.0)

    def replay(self, run: RecordedRun) -> list[Answer]:
        """What the nodes answer to the pictures of a run that were answered when it was recorded.

        Raises:
            StageTimeoutError: A node does not answer.
        """
        if run.recipe is None:
            return []
        last = nanoseconds_of(run.recipe.header.stamp)
        self._publish(run, topics.DOOR_RECIPE, last)
        found: list[Answer] = []
        for _, message in run.localizations:
            stamp_ns = nanoseconds_of(message.header.stamp)
            if stamp_ns not in run.pictures:
                continue
            if math.isfinite(self._rate):
                time.sleep(max(0, stamp_ns - last) * 1e-9 / self._rate)
            last = stamp_ns
            self._publish(run, topics.CAMERA_INFO, stamp_ns)
            self._publish(run, topics.IMAGE, stamp_ns)
            found.extend(self._answers(run, stamp_ns, first=not found))
        return found

    def _answers(self, run: RecordedRun, stamp_ns: int, first: bool) -> list[Answer]:
        localization = self._answer(topics.DOOR_LOCALIZATION, run, stamp_ns)
        answers = [localization_of(localization)]
        if not localization.accepted:
            return answers
        targets = self._answer(topics.PATH_TARGETS, run, stamp_ns)
        answers.append(targets_of(targets))
        handed_over = run.result is not None and bool(run.target_files or run.result.sha256)
        if first and targets.accepted and handed_over:
            data = render_target_file(program_of(targets), run.run_id)
            content = data if run.target_files else b""
            answers.append(target_file_answer(stamp_ns, content, hashlib.sha256(data).hexdigest()))
        return answers

    def _answer(self, topic: topics.Topic, run: RecordedRun, stamp_ns: int) -> Any:
        key = topic.name, run.run_id, stamp_ns
        self._wait(lambda: key in self._heard, ANSWER_LIMIT, f"no message came on {topic.name}")
        return self._heard[key]

    def _publish(self, run: RecordedRun, topic: topics.Topic, stamp_ns: int) -> None:
        data = run.serialized.get((topic.name, stamp_ns))
        if data is not None:
            self._publishers[topic.name].publish(data)

    def _listener(self, name: str) -> Callable[[Any], None]:
        def hear(message: Any) -> None:
            with self._changed:
                self._heard[name, message.run_id, nanoseconds_of(message.header.stamp)] = message
                self._changed.notify_all()

        return hear

    def _connected(self) -> bool:
        """Every input has its listeners, every answer its speaker."""
        listeners = {topics.DOOR_RECIPE.name: 2, topics.CAMERA_INFO.name: 1, topics.IMAGE.name: 1}
        return all(
            self._publishers[name].get_subscription_count() >= count for name, count in listeners.items()
        ) and all(
            self._node.count_publishers(topic.name) >= 1
            for topic in (topics.DOOR_LOCALIZATION, topics.PATH_TARGETS)
        )

    def _wait(self, condition: Callable[[], bool], limit: float, otherwise: str) -> None:
        deadline = time.monotonic() + limit
        with self._changed:
            while not condition():
                if time.monotonic() > deadline:
                    raise StageTimeoutError(f"live replay: {otherwise} (waited {limit:g} s)", limit=limit)
                self._changed.wait(0.05)
