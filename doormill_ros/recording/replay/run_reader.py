"""Sorts the messages of a bag into its runs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from doormill_ros.cell.graph.topic_names import (
    ABB_STATUS,
    ABB_TARGET_FILE,
    CAMERA_INFO,
    COMPRESSED,
    DOOR_LOCALIZATION,
    DOOR_POSE,
    DOOR_RECIPE,
    IMAGE,
    PATH_TARGETS,
    RUN_RESULT,
    SENSOR_LOCALIZATION,
    SENSOR_READING,
    name_of,
)
from doormill_ros.cell.graph.two_robots import robot_of
from doormill_ros.messages.stamps import nanoseconds_of
from doormill_ros.recording.bag_reader import BagMessage, read_bag
from doormill_ros.recording.errors import EmptyBagError
from doormill_ros.recording.replay.recorded_run import RecordedRun

#: Pictures kept until a recipe says whose they are: a recorder that falls behind writes topics in any order.
EARLY_PICTURES = 32


class _Collector:
    """Sorts messages into runs as they were recorded."""

    def __init__(self) -> None:
        self.runs: dict[str, RecordedRun] = {}
        self._in_hand: RecordedRun | None = None
        self._info: BagMessage | None = None
        self._early = RecordedRun("")
        self._requested = False

    def _run(self, run_id: str) -> RecordedRun:
        return self.runs.setdefault(run_id, RecordedRun(run_id))

    def recipe(self, item: BagMessage) -> None:
        before, run = self._in_hand, self._run(item.message.run_id)
        self._in_hand = run
        run.recipe = item.message
        run.begun_ns = item.stamp_ns
        run.requests.append((item.stamp_ns, self._requested))
        begun = nanoseconds_of(item.message.header.stamp)
        # Pictures of this run that were recorded ahead of its recipe, while no run or another one was in hand.
        for other in (before, self._early):
            if other is not None and other is not run:
                for stamp in [stamp for stamp in other.pictures if stamp >= begun]:
                    run.take_picture(other, stamp)
        self._early = RecordedRun("")

    def picture(self, item: BagMessage) -> None:
        stamp = nanoseconds_of(item.message.header.stamp)
        run = self._in_hand
        if run is None or stamp < nanoseconds_of(run.recipe.header.stamp):
            self._keep(self._early, item)
            if len(self._early.pictures) > EARLY_PICTURES:
                RecordedRun("").take_picture(self._early, next(iter(self._early.pictures)))
        else:
            self._keep(run, item)

    def _keep(self, run: RecordedRun, item: BagMessage) -> None:
        stamp = nanoseconds_of(item.message.header.stamp)
        if item.topic.endswith(COMPRESSED):
            if (IMAGE, stamp) in run.serialized:
                return
            run.serialized[COMPRESSED, stamp] = item.data
        else:
            run.serialized.pop((COMPRESSED, stamp), None)
            run.serialized[IMAGE, stamp] = item.data
        run.pictures[stamp] = item.message
        if self._info is not None:
            self._keep_info(run, stamp, self._info)

    @staticmethod
    def _keep_info(run: RecordedRun, stamp: int, item: BagMessage) -> None:
        run.camera_infos[stamp] = item.message
        run.serialized[CAMERA_INFO, stamp] = item.data

    def camera_info(self, item: BagMessage) -> None:
        self._info = item
        # What carries a picture's own stamp belongs to it, even when it was recorded after it.
        stamp, run = nanoseconds_of(item.message.header.stamp), self._in_hand
        if stamp in self._early.pictures:
            self._keep_info(self._early, stamp, item)
        elif run is not None and (stamp in run.pictures or not run.camera_infos):
            self._keep_info(run, stamp, item)

    def reading(self, item: BagMessage) -> None:
        run, stamp = self._run(item.message.run_id), nanoseconds_of(item.message.header.stamp)
        run.readings[stamp], run.serialized[SENSOR_READING, stamp] = item.message, item.data

    def sensed(self, item: BagMessage) -> None:
        self._run(item.message.run_id).sensed.append(item.message)

    def pose(self, item: BagMessage) -> None:
        if self._in_hand is not None:
            self._in_hand.poses[nanoseconds_of(item.message.header.stamp)] = item.message.pose

    def localization(self, item: BagMessage) -> None:
        run = self._run(item.message.run_id)
        run.localizations.append((item.stamp_ns, item.message))
        if item.message.accepted:
            run.poses.setdefault(nanoseconds_of(item.message.header.stamp), item.message.pose.pose)

    def targets(self, item: BagMessage) -> None:
        self._run(item.message.run_id).share(robot_of(item.topic)).targets.append(item.message)

    def target_file(self, item: BagMessage) -> None:
        if self._in_hand is not None and item.message.data:
            share = self._in_hand.share(robot_of(item.topic))
            share.target_files.append(item.message.data.encode("ascii", errors="replace"))

    def status(self, item: BagMessage) -> None:
        # Level and state in one message: two topics may be recorded in another order than they were sent.
        self._requested = bool(item.message.request)
        if self._in_hand is not None:
            if self._in_hand.result is None:
                self._in_hand.requests.append((item.stamp_ns, self._requested))
            # The end of milling may be recorded after the result that follows from it.
            self._in_hand.states.append((item.stamp_ns, item.message.state))

    def result(self, item: BagMessage) -> None:
        self._run(item.message.run_id).result = item.message


def read_runs(bag: Path) -> list[RecordedRun]:
    """The runs of a bag in the order in which they began.

    Raises:
        UnreadableBagError: No such bag, or damaged beyond reading.
        EmptyBagError: No run is in it.
    """
    collector = _Collector()
    take: dict[str, Callable[[BagMessage], None]] = {
        DOOR_RECIPE: collector.recipe,
        IMAGE: collector.picture,
        COMPRESSED: collector.picture,
        CAMERA_INFO: collector.camera_info,
        SENSOR_READING: collector.reading,
        SENSOR_LOCALIZATION: collector.sensed,
        DOOR_POSE: collector.pose,
        DOOR_LOCALIZATION: collector.localization,
        PATH_TARGETS: collector.targets,
        ABB_TARGET_FILE: collector.target_file,
        RUN_RESULT: collector.result,
        ABB_STATUS: collector.status,
    }

    def kind(topic: str) -> str:
        return name_of(topic, take)

    for item in read_bag(bag, kind):
        take[kind(item.topic)](item)
    runs = [run for run in collector.runs.values() if run.recipe is not None or run.result is not None]
    if not runs:
        raise EmptyBagError(
            f"bag {bag} holds no run (topics {DOOR_RECIPE} and {RUN_RESULT} are empty); record a whole run",
            bag=str(bag),
        )
    return runs
