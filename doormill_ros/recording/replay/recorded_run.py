"""One run of a bag: what went in, and what came out."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from typing import Any

from doormill_ros.abb.target_file.target_file import says_tool, without_tool
from doormill_ros.cell.graph.topic_names import (
    CAMERA_INFO,
    COMPRESSED,
    IMAGE,
)
from doormill_ros.cell.places.layout import CAMERA
from doormill_ros.messages.stamps import nanoseconds_of
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

    def take_picture(self, other: RecordedRun, stamp_ns: int) -> None:
        """Take over a picture that another run holds, with its camera info."""
        self.pictures[stamp_ns] = other.pictures.pop(stamp_ns)
        if stamp_ns in other.camera_infos:
            self.camera_infos[stamp_ns] = other.camera_infos.pop(stamp_ns)
        for topic in (IMAGE, COMPRESSED, CAMERA_INFO):
            if (topic, stamp_ns) in other.serialized:
                self.serialized[topic, stamp_ns] = other.serialized.pop((topic, stamp_ns))

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

    def in_recorded_form(self, share: RecordedShare, data: bytes) -> bytes:
        """A target file in the form of the recorded one: earlier ones do not say their tool."""
        plain = without_tool(data)
        if share.target_files:
            return data if says_tool(share.target_files[-1]) else plain
        return plain if hashlib.sha256(plain).hexdigest() == self.result.sha256 else data

    def _answers_of(self, share: RecordedShare) -> list[Answer]:
        found = [targets_of(message) for message in share.targets]
        accepted = [m for m in share.targets if m.accepted]
        if accepted and self.handed_over(share):
            data = share.target_files[-1] if share.target_files else b""
            stamp_ns = nanoseconds_of(accepted[0].header.stamp)
            found.append(target_file_answer(stamp_ns, data, "" if data else self.result.sha256))
        return found
