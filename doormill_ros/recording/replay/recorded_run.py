"""The runs of a bag: what went in, and what came out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from doormill_ros.cell.layout import CAMERA
from doormill_ros.messages.from_message import nanoseconds_of
from doormill_ros.recording.bag_reader import BagMessage, read_bag
from doormill_ros.recording.errors import EmptyBagError
from doormill_ros.recording.replay.answer import (
    Answer,
    localization_of,
    of_robot,
    recipe_of,
    result_answer,
    sensed_of,
    target_file_answer,
    targets_of,
)
from doormill_ros.recording.run_topics import (
    CAMERA_INFO,
    COMPRESSED,
    LOCALIZATION,
    PICTURE,
    POSE,
    READING,
    RECIPE,
    RUN_RESULT,
    SENSED,
    STATUS,
    TARGET_FILE,
    TARGETS,
    robot_of,
)


@dataclass
class RecordedShare:
    """What a robot was to mill.

    Attributes:
        targets: Target lists, accepted or refused.
        target_files: Content of target files that were handed over.
    """

    targets: list[Any] = field(default_factory=list)
    target_files: list[bytes] = field(default_factory=list)


@dataclass
class RecordedRun:
    """One run of one door.

    Attributes:
        run_id: Its name.
        recipe: The recipe in hand; None when none was found.
        pictures: Picture messages by stamp [ns].
        camera_infos: For each picture the camera info in force when it was answered.
        readings: Of sensors beside the camera, by stamp [ns].
        sensed: What each of several sensors found, the first one among them.
        poses: Accepted poses by stamp [ns].
        localizations: With the time at which each was recorded [ns].
        shares: By robot, as `SHARE_OF` has them, or "" for the only one.
        result: How the run ended; None when the recording stopped before.
        serialized: Pictures, camera infos and readings as recorded (CDR), by topic and stamp [ns].
        begun_ns: When the recipe was recorded [ns].
        requests: The request as abb/status tells it, the level at the begin first, with the time of recording [ns].
        states: State of abb/status with the time of recording [ns].
    """

    run_id: str
    recipe: Any = None
    pictures: dict[int, Any] = field(default_factory=dict)
    camera_infos: dict[int, Any] = field(default_factory=dict)
    readings: dict[int, Any] = field(default_factory=dict)
    sensed: list[Any] = field(default_factory=list)
    poses: dict[int, Any] = field(default_factory=dict)
    localizations: list[tuple[int, Any]] = field(default_factory=list)
    shares: dict[str, RecordedShare] = field(default_factory=dict)
    result: Any = None
    serialized: dict[tuple[str, int], bytes] = field(default_factory=dict)
    begun_ns: int = 0
    requests: list[tuple[int, bool]] = field(default_factory=list)
    states: list[tuple[int, str]] = field(default_factory=list)

    @property
    def door_id(self) -> str:
        """Door of the run."""
        return str((self.recipe or self.result).door_id)

    @property
    def shared(self) -> bool:
        """Two robots milled the door, or one of the two all of it."""
        return any(self.shares)

    def share(self, robot: str = "") -> RecordedShare:
        """What a robot was to mill, by default the only one."""
        return self.shares.setdefault(robot, RecordedShare())

    @property
    def image_transport(self) -> str:
        """How its pictures came, as `image_transport` names it."""
        return "compressed" if any(topic == COMPRESSED for topic, _ in self.serialized) else "raw"

    @property
    def sensors(self) -> tuple[str, ...]:
        """What found its door, the one first from whose pose was milled."""
        stamps = [nanoseconds_of(message.header.stamp) for _, message in self.localizations]
        of_first = [self.readings[stamp].sensor for stamp in stamps if stamp in self.readings]
        names = [*(of_first or [CAMERA]), *(message.sensor for message in self.sensed)]
        return tuple(dict.fromkeys(str(name) for name in names))

    def beside(self, stamp_ns: int) -> list[tuple[str, bytes]]:
        """The latest of what the other sensors than the one of that stamp took, serialized, with the topics."""
        own = self.readings[stamp_ns].sensor if stamp_ns in self.readings else CAMERA
        latest = {reading.sensor: stamp for stamp, reading in sorted(self.readings.items())}
        if self.pictures:
            latest[CAMERA] = max(self.pictures)
        stamps = [stamp for sensor, stamp in latest.items() if sensor != own]
        return [(topic, data) for (topic, at), data in self.serialized.items() if at in stamps]

    def answers(self) -> list[Answer]:
        """What was recorded of every stage."""
        found = [] if self.recipe is None else [recipe_of(self.recipe)]
        found += [localization_of(message) for _, message in self.localizations]
        found += [sensed_of(message) for message in self.sensed]
        for robot, share in sorted(self.shares.items()):
            found += [of_robot(robot, answer) for answer in self._answers_of(share)]
        if self.result is not None:
            found.append(result_answer(self.result.success, self.result.error_code, self.result.message))
        return found

    def handed_over(self, share: RecordedShare) -> bool:
        """Whether the run came so far that the robot of a share got a target file."""
        # The result tells one checksum, that of the only robot or of the first one's.
        return self.result is not None and bool(
            share.target_files or (self.result.sha256 and not self.shared)
        )

    def _answers_of(self, share: RecordedShare) -> list[Answer]:
        found = [targets_of(message) for message in share.targets]
        accepted = [m for m in share.targets if m.accepted]
        if accepted and self.handed_over(share):
            data = share.target_files[-1] if share.target_files else b""
            stamp_ns = nanoseconds_of(accepted[0].header.stamp)
            found.append(target_file_answer(stamp_ns, data, "" if data else self.result.sha256))
        return found


class _Collector:
    """Sorts messages into runs as they were recorded."""

    def __init__(self) -> None:
        self.runs: dict[str, RecordedRun] = {}
        self._in_hand: RecordedRun | None = None
        self._info: BagMessage | None = None
        self._early: list[BagMessage] = []
        self._requested = False

    def _run(self, run_id: str) -> RecordedRun:
        return self.runs.setdefault(run_id, RecordedRun(run_id))

    def recipe(self, item: BagMessage) -> None:
        run = self._in_hand = self._run(item.message.run_id)
        run.recipe = item.message
        run.begun_ns = item.stamp_ns
        run.requests.append((item.stamp_ns, self._requested))
        begun = nanoseconds_of(item.message.header.stamp)
        for picture in self._early:
            if nanoseconds_of(picture.message.header.stamp) >= begun:
                self._keep(run, picture)
        self._early.clear()

    def picture(self, item: BagMessage) -> None:
        stamp = nanoseconds_of(item.message.header.stamp)
        run = self._in_hand
        if run is None or stamp < nanoseconds_of(run.recipe.header.stamp):
            self._early = [item]
        else:
            self._keep(run, item)

    def _keep(self, run: RecordedRun, item: BagMessage) -> None:
        stamp = nanoseconds_of(item.message.header.stamp)
        if item.topic.endswith(COMPRESSED):
            if (PICTURE, stamp) in run.serialized:
                return
            run.serialized[COMPRESSED, stamp] = item.data
        else:
            run.serialized.pop((COMPRESSED, stamp), None)
            run.serialized[PICTURE, stamp] = item.data
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
        run = self._in_hand
        if run is not None:
            stamp = nanoseconds_of(item.message.header.stamp)
            if stamp in run.pictures or not run.camera_infos:
                self._keep_info(run, stamp, item)

    def reading(self, item: BagMessage) -> None:
        run, stamp = self._run(item.message.run_id), nanoseconds_of(item.message.header.stamp)
        run.readings[stamp], run.serialized[READING, stamp] = item.message, item.data

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
        RECIPE: collector.recipe,
        PICTURE: collector.picture,
        COMPRESSED: collector.picture,
        CAMERA_INFO: collector.camera_info,
        READING: collector.reading,
        SENSED: collector.sensed,
        POSE: collector.pose,
        LOCALIZATION: collector.localization,
        TARGETS: collector.targets,
        TARGET_FILE: collector.target_file,
        RUN_RESULT: collector.result,
        STATUS: collector.status,
    }

    def kind(topic: str) -> str | None:
        return next((name for name in take if topic.endswith("/" + name)), None)

    for item in read_bag(bag, kind):
        take[str(kind(item.topic))](item)
    runs = [run for run in collector.runs.values() if run.recipe is not None or run.result is not None]
    if not runs:
        raise EmptyBagError(
            f"bag {bag} holds no run (topics {RECIPE} and {RUN_RESULT} are empty); record a whole run",
            bag=str(bag),
        )
    return runs
