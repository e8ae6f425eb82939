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
from doormill_ros.errors import one_line
from doormill_ros.messages.stamps import nanoseconds_of
from doormill_ros.recipes.stamp import STAMP
from doormill_ros.recording.run_topics import LOCALIZATION, RECIPE, RUN_RESULT, TARGETS

TOPICS = (RECIPE, LOCALIZATION, TARGETS, RUN_RESULT)  #: that tell of a run, without the cell's namespace
SOFTWARE, CELL = "software", "cell"  #: keys of what the recorder says of itself in metadata.yaml
LONGEST_NAME = 200  # characters of a run's or a door's name
_LARGEST = 2**63 - 1  # of a database's whole numbers
_STAGES = ("picture_to_pose", "pose_to_targets", "targets_to_ready", "request_to_ready")


def topic_of(full_name: str) -> str | None:
    """The one of `TOPICS` that a full topic name stands for, with or without a namespace."""
    return next((topic for topic in TOPICS if full_name.endswith(f"/{topic}")), None)


@dataclass
class _Told:
    """The messages of one run."""

    recipe: Any = None
    localizations: dict[int, Any] = field(default_factory=dict)
    targets: Any = None
    result: Any = None
    begun_ns: int | None = None
    ended_ns: int | None = None


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
        told = self._told.setdefault(str(message.run_id), _Told())
        if topic == RECIPE:
            told.recipe, told.begun_ns = message, _whole(stamp_ns)
        elif topic == LOCALIZATION:
            if message.accepted:
                told.localizations[nanoseconds_of(message.header.stamp)] = message
        elif topic == TARGETS:
            told.targets = message
        else:
            told.result, told.ended_ns = message, _whole(stamp_ns)
        return topic == RUN_RESULT

    def runs(self) -> list[CataloguedRun]:
        """A row for each run that has a recipe or a result; what is wrong with one keeps no other out."""
        found, self.refused = [], ""
        for run_id, told in self._told.items():
            if told.recipe is None and told.result is None:
                continue
            try:
                found.append(self._run(run_id, told))
            except BadRunRecordError as error:
                self.refused = self.refused or error.message
            except (AttributeError, TypeError, ValueError) as error:
                self.refused = self.refused or f"run {run_id!r} has a message of another type: {error}"
        return found

    def _run(self, run_id: str, told: _Told) -> CataloguedRun:
        first = told.recipe if told.recipe is not None else told.result
        run = CataloguedRun(
            run_id=_name(run_id, "run"),
            door_id=_name(str(first.door_id), "door"),
            cell=one_line(self._recorder.get(CELL, "")),
            software=one_line(self._recorder.get(SOFTWARE, "")),
            begun_ns=told.begun_ns,
            ended_ns=told.ended_ns,
        )
        if told.recipe is not None:
            digest = recipe_digest(told.recipe.document)
            run = replace(run, recipe_version=_number(told.recipe.version), recipe_digest=digest)
        if told.targets is not None:
            run = _with_targets(run, told.targets)
        if told.localizations:
            run = _with_pose(run, told)
        return run if told.result is None else _with_result(run, told.result)


def _with_targets(run: CataloguedRun, message: Any) -> CataloguedRun:
    return replace(
        run,
        robot_model=one_line(message.robot_model),
        model_version=_version(message),
        cycle_time=_finite(message.cycle_time),
        largest_correction=_finite(message.largest_correction),
        expected_error=_finite(message.expected_error),
    )


def _with_pose(run: CataloguedRun, told: _Told) -> CataloguedRun:
    """The pose that the targets follow, else the last one."""
    wanted = -1 if told.targets is None else nanoseconds_of(told.targets.header.stamp)
    message: Any = told.localizations.get(wanted) or [*told.localizations.values()][-1]
    p, q = message.pose.pose.position, message.pose.pose.orientation
    pose = {"x": p.x, "y": p.y, "z": p.z, "qx": q.x, "qy": q.y, "qz": q.z, "qw": q.w}
    pose |= {name: getattr(message, name) for name in ("offset_y", "offset_z", "offset_rotation", "residual")}
    finite: dict[str, Any] = {name: _finite(value) for name, value in pose.items()}
    return replace(run, **finite)


def _with_result(run: CataloguedRun, message: Any) -> CataloguedRun:
    measured = bool(message.measured)
    times: dict[str, Any] = {name: _finite(getattr(message.times, name)) for name in _STAGES}
    return replace(
        run,
        success=bool(message.success),
        error_code=_number(message.error_code),
        message=one_line(message.message),
        measured=measured,
        worst_feature=one_line(message.worst_feature),
        deviation=_finite(message.deviation) if measured else None,
        tolerance=_finite(message.tolerance) if measured else None,
        **times,
    )


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
