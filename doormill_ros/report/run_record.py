"""What a bag tells about one run."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from doormill_ros.cell.graph import topic_names
from doormill_ros.cell.graph.two_robots import SECOND, in_robot
from doormill_ros.cell.output.inspection_files import BESIDE_BAG, DESCRIPTION
from doormill_ros.measurements.inspections.inspection import Inspection, read_inspection
from doormill_ros.messages.stamps import seconds_of
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.errors import EmptyBagError

LATEST = (
    topic_names.DOOR_RECIPE,
    topic_names.DOOR_LOCALIZATION,
    topic_names.DOOR_OVERLAY,
    topic_names.IMAGE,
    topic_names.PATH_TARGETS,
    topic_names.ABB_TARGET_FILE,
    topic_names.RUN_RESULT,
    topic_names.DOOR_PLACEMENT,
    topic_names.EXECUTED_PATH,
    topic_names.MILLED_DOOR,
    topic_names.RUN_VERDICT,
)
#: Of any run, also of one that ended before; the gauge's before those that were handed in as files.
INSPECTIONS = (topic_names.DOOR_INSPECTION, topic_names.MODEL_INSPECTED)
_OF_THE_SECOND = f"/{in_robot(SECOND)}/"  #: in the topics of the second of two robots


@dataclass
class HandshakeStep:
    """One state of the handshake: when it began [s since the first], which, why."""

    begun: float
    state: str
    reason: str


@dataclass
class RunRecord:
    """The last message of each topic that belongs to the run, and the handshake's course.

    Attributes:
        bag: Where it was read from.
        latest: Message by topic name without the leading slash.
        handshake: States in order.
        counts: Messages by topic.
        beside: Inspection that lies beside the bag and is of the run.
    """

    bag: Path
    latest: dict[str, Any] = field(default_factory=dict)
    handshake: list[HandshakeStep] = field(default_factory=list)
    counts: dict[str, int] = field(default_factory=dict)
    beside: Inspection | None = None

    @property
    def shared(self) -> bool:
        """Two robots milled the door."""
        return any(_OF_THE_SECOND in f"/{topic}" for topic in self.counts)

    @property
    def inspection(self) -> Any:
        """What was measured on the door with a gauge, None where nobody did."""
        return next((self.latest[topic] for topic in INSPECTIONS if topic in self.latest), self.beside)

    def get(self, topic: str) -> Any:
        """The topic's last message, None when there is none."""
        return self.latest.get(topic)


def _in_the_cell(topic: str) -> str:
    """The name of a topic without the namespace of the cell that it was recorded in, or of the first of two robots."""
    if _OF_THE_SECOND in topic:
        return topic.lstrip("/")
    return topic_names.name_of(topic, (*LATEST, topic_names.ABB_STATUS, *INSPECTIONS)) or topic.lstrip("/")


def read_run(bag: Path) -> RunRecord:
    """The last run of a bag.

    Raises:
        UnreadableBagError: The bag cannot be read.
        EmptyBagError: No run ended in it.
        DataSetError: The inspection beside it cannot be read.
    """
    record = RunRecord(bag)
    steps: list[tuple[float, str, str]] = []
    inspections: dict[tuple[str, str], Any] = {}
    for item in read_bag(bag):
        topic = _in_the_cell(item.topic)
        record.counts[topic] = record.counts.get(topic, 0) + 1
        if topic in LATEST:
            record.latest[topic] = item.message
        elif topic in INSPECTIONS:
            inspections[topic, item.message.run_id] = item.message
        elif topic == topic_names.ABB_STATUS:
            steps.append((seconds_of(item.message.since), item.message.state, item.message.reason))
    result = record.get(topic_names.RUN_RESULT)
    if result is None:
        raise EmptyBagError(
            f"bag {bag} holds no run that ended (topic {topic_names.RUN_RESULT} is empty); record a whole run",
            bag=str(bag),
        )
    for topic, message in list(record.latest.items()):
        if getattr(message, "run_id", result.run_id) != result.run_id:
            del record.latest[topic]
    for topic in INSPECTIONS:
        if (topic, result.run_id) in inspections:
            record.latest[topic] = inspections[topic, result.run_id]
    beside = bag.parent / BESIDE_BAG
    if (beside / DESCRIPTION).is_file() and (found := read_inspection(beside)).run_id == result.run_id:
        record.beside = found
    begun = steps[0][0] if steps else 0.0
    record.handshake = [HandshakeStep(at - begun, state, reason) for at, state, reason in steps]
    return record
