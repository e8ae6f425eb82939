"""What a bag tells about one run."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from doormill_ros.measurements.inspection import BESIDE_BAG, DESCRIPTION, Inspection, read_inspection
from doormill_ros.messages.stamps import seconds_of
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.errors import EmptyBagError

LATEST = (
    "door/recipe",
    "door/localization",
    "door/overlay",
    "camera/image_raw",
    "path/targets",
    "abb/target_file",
    "run/result",
    "simulation/door_placement",
    "simulation/executed_path",
    "simulation/milled_door",
    "simulation/verdict",
)
STATUS = "abb/status"
#: Of any run, also of one that ended before; the gauge's before those that were handed in as files.
INSPECTIONS = ("door/inspection", "model/inspected")
SECOND = "/robot2/"  #: in the topics of the second of two robots


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
        return any(SECOND in f"/{topic}" for topic in self.counts)

    @property
    def inspection(self) -> Any:
        """What was measured on the door with a gauge, None where nobody did."""
        return next((self.latest[topic] for topic in INSPECTIONS if topic in self.latest), self.beside)

    def get(self, topic: str) -> Any:
        """The topic's last message, None when there is none."""
        return self.latest.get(topic)


def _in_the_cell(topic: str) -> str:
    """The name of a topic without the namespace of the cell that it was recorded in, or of the first of two robots."""
    if SECOND in topic:
        return topic.lstrip("/")
    return next(
        (name for name in (*LATEST, STATUS, *INSPECTIONS) if topic.endswith(f"/{name}")), topic.lstrip("/")
    )


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
        elif topic == STATUS:
            steps.append((seconds_of(item.message.since), item.message.state, item.message.reason))
    result = record.get("run/result")
    if result is None:
        raise EmptyBagError(
            f"bag {bag} holds no run that ended (topic run/result is empty); record a whole run",
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
