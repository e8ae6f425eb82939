"""Bags of runs that are drawn instead of milled, with messages of the installed types."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message

from doormill_interfaces.msg import DoorLocalization, DoorRecipe, RunResult, TargetArray
from doormill_ros.recording.bag_writer import BagWriter

TYPES: dict[str, Any] = {
    "door/recipe": DoorRecipe,
    "door/localization": DoorLocalization,
    "path/targets": TargetArray,
    "run/result": RunResult,
}
RECORDER = {"software": "0.1.0+0123456789ab", "cell": "oven/cell1"}
BEGUN_NS = 1_795_000_000_000_000_000
DAY_NS = 86_400_000_000_000


@dataclass(frozen=True)
class DrawnRun:
    """A run as it is told of: None for a stage that it did not reach.

    Attributes:
        begun_ns: When the recipe is recorded; the other messages follow a second apart each.
        offsets: Of the localizations, the last one is the one that counts.
        correction: Of the targets [m].
        success: None for a run without an end.
    """

    run_id: str
    door_id: str = "door_1"
    begun_ns: int = BEGUN_NS
    version: int = 1
    offsets: tuple[float, ...] = (0.001,)
    correction: float | None = 2e-4
    success: bool | None = True
    error_code: int = 0
    deviation: float | None = None

    def messages(self) -> Iterator[tuple[str, Any, int]]:
        """Topic, message and time of recording of each message."""
        stamp = self.begun_ns
        document = json.dumps(
            {"door_id": self.door_id, "width_mm": 800, "version": self.version, "author": "anna"}
        )
        recipe = DoorRecipe(run_id=self.run_id, door_id=self.door_id, version=self.version, document=document)
        yield "door/recipe", recipe, stamp
        for offset in self.offsets:
            stamp += 10**9
            found = DoorLocalization(run_id=self.run_id, door_id=self.door_id, accepted=True, offset_y=offset)
            found.header.stamp.sec = stamp // 10**9
            found.pose.pose.position.x = 2.0 + offset
            yield "door/localization", found, stamp
        if self.correction is not None:
            stamp += 10**9
            targets = TargetArray(
                run_id=self.run_id, robot_model="irb6600", largest_correction=self.correction
            )
            targets.header.stamp.sec = stamp // 10**9 - 1
            yield "path/targets", targets, stamp
        if self.success is not None:
            stamp += 10**9
            result = RunResult(run_id=self.run_id, door_id=self.door_id, success=self.success)
            result.error_code, result.measured = self.error_code, self.deviation is not None
            result.deviation = self.deviation or 0.0
            yield "run/result", result, stamp


def decode(topic: str, data: bytes) -> Any:
    """The message of a topic."""
    return deserialize_message(data, TYPES[topic])


def write_run_bag(
    folder: Path,
    runs: Sequence[DrawnRun],
    taken: Any = None,
    recorder: dict[str, str] = RECORDER,
    close: bool = True,
) -> Path:
    """Record runs one after the other; `taken` is called with topic, bytes and time of each message on its way."""
    writer = BagWriter(folder, ros_distro="kilted", custom=recorder)
    for topic, kind in TYPES.items():
        writer.add_topic(f"/{topic}", f"doormill_interfaces/msg/{kind.__name__}")
    for run in runs:
        for topic, message, stamp in run.messages():
            data = serialize_message(message)
            writer.write(f"/{topic}", data, stamp)
            if taken is not None:
                taken(topic, data, stamp)
    if close:
        writer.close()
    else:
        writer.flush(force=True)
    return folder


def write_inspection_note(folder: Path, run_id: str, measured_at: str = "2026-11-22T08:00:00Z") -> Path:
    """inspection.yaml of a door; the catalogue reads no points."""
    folder.mkdir(parents=True, exist_ok=True)
    document = {
        "schema": "doormill/inspection/1",
        "run_id": run_id,
        "bag": "bag",
        "measured_at": measured_at,
    }
    (folder / "inspection.yaml").write_text(yaml.safe_dump(document))
    return folder


def drawn_runs(name: str) -> st.SearchStrategy[list[DrawnRun]]:
    """Some runs of one recording, their names begin with `name`."""
    size = st.floats(-0.01, 0.01)
    one = st.builds(
        DrawnRun,
        run_id=st.just(""),
        door_id=st.sampled_from(["door_1", "dør 2", "x" * 200]),
        version=st.integers(0, 2**32 - 1),
        offsets=st.lists(size | st.sampled_from([float("nan"), float("inf")]), max_size=3).map(tuple),
        correction=st.none() | size,
        success=st.none() | st.booleans(),
        error_code=st.integers(0, 2**16 - 1),
        deviation=st.none() | size,
    )

    def named(runs: list[DrawnRun]) -> list[DrawnRun]:
        return [
            DrawnRun(**{**vars(run), "run_id": f"{name}{index}", "begun_ns": BEGUN_NS + index * 60 * 10**9})
            for index, run in enumerate(runs)
        ]

    return st.lists(one, max_size=4).map(named)
