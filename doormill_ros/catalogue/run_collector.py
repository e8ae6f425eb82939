"""The rows of a bag from its messages, whether they come out of it or are on their way into it."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from doormill_ros.catalogue.errors import BadRunRecordError
from doormill_ros.catalogue.run import NO_VERSION, CataloguedRun
from doormill_ros.cell.graph.topic_names import (
    DOOR_LOCALIZATION,
    DOOR_RECIPE,
    PATH_TARGETS,
    RUN_RESULT,
    name_of,
)
from doormill_ros.errors import one_line
from doormill_ros.messages.stamps import nanoseconds_of
from doormill_ros.recipes.stamp import STAMP

#: That tell of a run, without the cell's namespace.
TOPICS = (DOOR_RECIPE, DOOR_LOCALIZATION, PATH_TARGETS, RUN_RESULT)
SOFTWARE, CELL = "software", "cell"  #: keys of what the recorder says of itself in metadata.yaml
LONGEST_NAME = 200  # characters of a run's or a door's name
_LARGEST = 2**63 - 1  # of a database's whole numbers
_STAGES = ("picture_to_pose", "pose_to_targets", "targets_to_ready", "request_to_ready")


def topic_of(full_name: str) -> str:
    """The one of `TOPICS` that a full topic name stands for, with or without a namespace; empty for none."""
    return name_of(full_name, TOPICS)


@dataclass
class _Told:
    """What the messages of one run told: no message is kept, a recorder sees hundreds of runs."""

    run: CataloguedRun
    of_recipe: bool = False
    of_result: bool = False
    poses: dict[int, dict[str, Any]] = field(default_factory=dict)  # by the picture's stamp
    targets_ns: int = -1  # stamp of the picture that the targets follow
    refused: dict[str, str] = field(default_factory=dict)  # by topic


class RunCollector:
    """Takes the messages of a bag in the order in which they are recorded.

    Args:
        recorder: What its recorder says of itself, see `SOFTWARE` and `CELL`.

    Attributes:
        refused: Of which run `runs` made no row, and why; empty where it made all.
    """

    def __init__(self, recorder: Mapping[str, str]) -> None:
        self.refused = ""
        self._recorder = recorder
        self._told: dict[str, _Told] = {}
        self._touched: dict[str, None] = {}

    def take(self, topic: str, message: Any, stamp_ns: int) -> bool:
        """Note a message.

        Args:
            topic: One of `TOPICS`.
            message: Of its type, from whatever library.
            stamp_ns: When it was recorded [ns since the epoch].

        Returns:
            Whether a run has ended with it.

        Raises:
            BadRunRecordError: The message is of another type.
        """
        try:
            return self._take(topic, message, stamp_ns)
        except (AttributeError, TypeError, ValueError) as error:
            raise BadRunRecordError(
                f"a message on {topic} is of another type: {error}; take another copy of the bag"
            ) from error

    def _take(self, topic: str, message: Any, stamp_ns: int) -> bool:
        run_id = str(message.run_id)
        told = self._told.get(run_id)
        if told is None:
            cell, software = (one_line(self._recorder.get(key, "")) for key in (CELL, SOFTWARE))
            told = self._told[run_id] = _Told(CataloguedRun(run_id, cell=cell, software=software))
        self._touched[run_id] = None
        if topic == DOOR_LOCALIZATION:
            if message.accepted:
                told.poses[nanoseconds_of(message.header.stamp)] = _pose(message)
            return False
        told.refused.pop(topic, None)
        try:
            _READERS[topic](told, message, _whole(stamp_ns))
        except BadRunRecordError as error:
            told.refused[topic] = error.message
        except (AttributeError, TypeError, ValueError) as error:
            told.refused[topic] = f"run {run_id!r} has a message of another type: {error}"
        return topic == RUN_RESULT

    def runs(self, touched: bool = False) -> list[CataloguedRun]:
        """A row for each run that has a recipe or a result; what is wrong with one keeps no other out.

        Args:
            touched: Only of runs that were told of since `noted`.
        """
        found, self.refused = [], ""
        for run_id in self._touched if touched else self._told:
            told = self._told[run_id]
            if not (told.of_recipe or told.of_result):
                continue
            try:
                _name(run_id, "run")
                if told.refused:
                    raise BadRunRecordError(next(iter(told.refused.values())))
                found.append(_with_pose(told))
            except BadRunRecordError as error:
                self.refused = self.refused or error.message
        return found

    def noted(self) -> None:
        """What was told until now is where it belongs."""
        self._touched.clear()


def _read_recipe(told: _Told, message: Any, stamp_ns: int | None) -> None:
    told.of_recipe = True
    told.run = replace(
        told.run,
        begun_ns=stamp_ns,
        door_id=_name(str(message.door_id), "door"),
        recipe_version=_number(message.version),
        recipe_digest=recipe_digest(message.document),
    )


def _read_targets(told: _Told, message: Any, stamp_ns: int | None) -> None:
    told.targets_ns = nanoseconds_of(message.header.stamp)
    told.run = replace(
        told.run,
        robot_model=one_line(message.robot_model),
        model_version=_version(message),
        cycle_time=_finite(message.cycle_time),
        largest_correction=_finite(message.largest_correction),
        expected_error=_finite(message.expected_error),
    )


def _read_result(told: _Told, message: Any, stamp_ns: int | None) -> None:
    told.of_result = True
    measured = bool(message.measured)
    times: dict[str, Any] = {name: _finite(getattr(message.times, name)) for name in _STAGES}
    told.run = replace(
        told.run,
        ended_ns=stamp_ns,
        door_id=told.run.door_id if told.of_recipe else _name(str(message.door_id), "door"),
        success=bool(message.success),
        error_code=_number(message.error_code),
        message=one_line(message.message),
        measured=measured,
        worst_feature=one_line(message.worst_feature),
        deviation=_finite(message.deviation) if measured else None,
        tolerance=_finite(message.tolerance) if measured else None,
        **times,
    )


_READERS = {DOOR_RECIPE: _read_recipe, PATH_TARGETS: _read_targets, RUN_RESULT: _read_result}


def _pose(message: Any) -> dict[str, Any]:
    p, q = message.pose.pose.position, message.pose.pose.orientation
    pose = {"x": p.x, "y": p.y, "z": p.z, "qx": q.x, "qy": q.y, "qz": q.z, "qw": q.w}
    pose |= {name: getattr(message, name) for name in ("offset_y", "offset_z", "offset_rotation", "residual")}
    return {name: _finite(value) for name, value in pose.items()}


def _with_pose(told: _Told) -> CataloguedRun:
    """With the pose that the targets follow, else the last one."""
    if not told.poses:
        return told.run
    pose = told.poses.get(told.targets_ns) or [*told.poses.values()][-1]
    return replace(told.run, **pose)


def _version(message: Any) -> str:
    """Of the robot's model; bags that were recorded before there was one tell of none."""
    found = getattr(message, "model_version", None)
    return NO_VERSION if found is None else one_line(str(found))


def recipe_digest(document: str) -> str:
    """SHA-256 of a recipe as it travels in a message, without who saved it when; of the text where it is no JSON."""
    try:
        content = json.loads(document)
        content = {key: value for key, value in content.items() if key not in STAMP}
        document = json.dumps(content, sort_keys=True, separators=(",", ":"))
    except (ValueError, AttributeError, RecursionError):
        pass
    return hashlib.sha256(document.encode("utf-8", errors="replace")).hexdigest()


def _name(text: str, what: str) -> str:
    if not 0 < len(text) <= LONGEST_NAME or not text.isprintable():
        raise BadRunRecordError(
            f"found the {what} {text!r}, allowed are 1 to {LONGEST_NAME} printable characters; such a run is not "
            "catalogued, look at its bag",
            found=text,
        )
    return text


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _number(value: int) -> int:
    if not 0 <= value <= _LARGEST:
        raise ValueError(f"found {value}, allowed is a whole number up to {_LARGEST}")
    return int(value)


def _whole(value: int) -> int | None:
    return int(value) if 0 <= value <= _LARGEST else None
