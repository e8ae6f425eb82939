"""What the bag of one run says of camera, clamp, other sensors and controller."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.graph.topic_names import (
    ABB_STATUS,
    CAMERA_MOVED,
    DOOR_LOCALIZATION,
    DOOR_RECIPE,
    EXECUTED_PATH,
    PATH_TARGETS,
    RUN_RESULT,
    SENSOR_LOCALIZATION,
    SPINDLE_LOAD,
    name_of,
)
from doormill_ros.cell.places.layout import CAMERA, CellLayout, load_layout
from doormill_ros.messages.from_message import sensed_door_of
from doormill_ros.messages.stamps import seconds_of
from doormill_ros.recording.bag_folders import bags_in
from doormill_ros.recording.bag_reader import read_bag, topics_of
from doormill_ros.recording.errors import UnreadableBagError

_TOPICS = (
    DOOR_LOCALIZATION,
    SENSOR_LOCALIZATION,
    CAMERA_MOVED,
    ABB_STATUS,
    PATH_TARGETS,
    DOOR_RECIPE,
    RUN_RESULT,
    EXECUTED_PATH,
    SPINDLE_LOAD,
)
_BAG = "bag"
FEWEST_LOADS = 20  #: while a spindle turns, from which on they tell its mean
STANDING = 0.02  #: a spindle that turns takes more of its nominal power
IN_AIR = 0.1  #: share of the time in which a turning spindle cuts nothing, at least
LIFTED = 3.0  #: standard deviations of noise
_QUARTER = 0.4506  #: of differences of two numbers of deviation 1 a quarter is smaller
_IN_PLANE = (1, 2, 3)  #: y, z and the rotation about x in a covariance


@dataclass(frozen=True, eq=False)
class FoundDoor:
    """Where something finds the door, against its nominal place.

    Attributes:
        offset: y, z [m] and rotation about base x [rad], shape (3,); nan for what it does not see.
        std: Stated standard deviations, shape (3,).
    """

    offset: FloatArray
    std: FloatArray


@dataclass(frozen=True, eq=False)
class UngaugedRun:
    """What is known of one run; whatever its bag does not hold is empty, None or nan.

    Attributes:
        name: Of the run, as it is told.
        run_id: Its id.
        recipe: What was milled.
        width: Of the door [m].
        time: When it began [s since the epoch].
        pictures: What each picture of the door said.
        residuals: Root mean square distance of its edge points from their line, by picture, shape (m,) [m].
        sensors: What every other sensor said, by its name.
        marks: Way along y and z [m] and turn about x [rad] of the camera by its marks, shape (3,); None without.
        cycle_time: Predicted [s].
        milling: From the begin of milling to its end [s].
        answer: From the ready signal until the controller has taken it [s].
        link: From the begin of writing targets to the ready signal [s].
        work: Of the cut: mean load of the spindle above what it takes in the air, times the time of milling [s of its
            nominal power].
        ended: The bag tells how it ended.
    """

    name: str
    run_id: str
    recipe: str
    width: float
    time: float
    pictures: tuple[FoundDoor, ...] = ()
    residuals: FloatArray = field(default_factory=lambda: np.zeros(0))
    sensors: Mapping[str, FoundDoor] = field(default_factory=dict)
    marks: FloatArray | None = None
    cycle_time: float = float("nan")
    milling: float = float("nan")
    answer: float = float("nan")
    link: float = float("nan")
    work: float = float("nan")
    ended: bool = False


def ungauged_runs(folder: Path) -> list[UngaugedRun]:
    """The runs of all bags in a folder, in the order in which they began.

    Raises:
        BagError: A bag cannot be read, or there is none.
    """
    layout = load_layout()
    found: dict[str, UngaugedRun] = {}
    for bag in bags_in([folder]):
        for run in runs_of_bag(bag, layout):
            found.setdefault(run.run_id, run)
    if not found:
        raise UnreadableBagError(
            f"{folder} holds no bag with a door that was localized or milled; give a folder with bags of runs",
            folder=str(folder),
        )
    return sorted(found.values(), key=lambda run: (run.time, run.run_id))


def runs_of_bag(bag: Path, layout: CellLayout) -> Iterator[UngaugedRun]:
    """The runs of one bag.

    Raises:
        BagError: It cannot be read.
    """
    names = [topic for topic in topics_of(bag) if name_of(topic, _TOPICS)]
    told: dict[str, dict[str, list[Any]]] = {}
    moved: dict[float, Any] = {}
    for item in read_bag(bag, names) if names else ():
        kind = name_of(item.topic, _TOPICS)
        if kind == CAMERA_MOVED:
            moved[seconds_of(item.message.header.stamp)] = item.message.twist
        elif item.message.run_id and getattr(item.message, "accepted", True):
            told.setdefault(item.message.run_id, {}).setdefault(kind, []).append(item.message)
    # A cell that mills a shift keeps a bag in the folder of each door.
    folder = bag.resolve()
    name = (folder.parent if folder.name == _BAG else folder).name
    for run_id, messages in told.items():
        run = _run(run_id, messages, moved, layout)
        if run is not None:
            yield replace(run, name=name) if len(told) == 1 else run


def _run(
    run_id: str, told: Mapping[str, list[Any]], moved: Mapping[float, Any], layout: CellLayout
) -> UngaugedRun | None:
    if DOOR_RECIPE not in told or not (DOOR_LOCALIZATION in told or ABB_STATUS in told):
        return None
    recipe, pictures = told[DOOR_RECIPE][-1], told.get(DOOR_LOCALIZATION, [])
    stamps = [seconds_of(message.header.stamp) for message in [recipe, *pictures]]
    states = {message.state: seconds_of(message.since) for message in told.get(ABB_STATUS, [])}
    milling = _between(states, "milling", "done")
    if EXECUTED_PATH in told and len(told[EXECUTED_PATH][-1].time):
        milling = float(told[EXECUTED_PATH][-1].time[-1])  # by the clock of a simulated controller
    twists = [moved[stamp] for stamp in stamps if stamp in moved]
    return UngaugedRun(
        name=run_id,
        run_id=run_id,
        recipe=recipe.door_id,
        width=float(recipe.width),
        time=next((stamp for stamp in reversed(stamps) if stamp > 0.0), 0.0),
        pictures=tuple(
            FoundDoor(
                np.array([one.offset_y, one.offset_z, one.offset_rotation], dtype=float),
                _stated(one.pose.covariance),
            )
            for one in pictures
        ),
        residuals=np.array([one.residual for one in pictures], dtype=float),
        sensors={
            one.sensor: _sensed(one, float(recipe.width), layout)
            for one in told.get(SENSOR_LOCALIZATION, [])
            if one.sensor != CAMERA
        },
        marks=np.mean([[t.linear.y, t.linear.z, t.angular.x] for t in twists], axis=0) if twists else None,
        cycle_time=float(told[PATH_TARGETS][-1].cycle_time) if PATH_TARGETS in told else float("nan"),
        milling=milling,
        answer=_between(states, "ready", "acknowledged"),
        link=_between(states, "writing", "ready"),
        work=milling * cutting_load(np.array([one.load for one in told.get(SPINDLE_LOAD, [])], dtype=float)),
        ended=RUN_RESULT in told,
    )


def cutting_load(loads: FloatArray) -> float:
    """Mean share of its nominal power that a spindle gives to the wood, from loads while milling, shape (n,).

    What it takes in the air is the middle of its lowest level: of loads that noise alone, as it is between most
    neighbours, may lift above the least tenth of them.
    """
    loads = loads[np.isfinite(loads)]
    turning = loads[loads > STANDING]
    if len(turning) < FEWEST_LOADS:
        return float("nan")
    noise = np.quantile(np.abs(np.diff(turning)), 0.25) / _QUARTER
    air = np.median(turning[turning <= np.quantile(turning, IN_AIR) + LIFTED * noise])
    return float(np.sum(turning - air) / len(loads))


def _between(states: Mapping[str, float], one: str, other: str) -> float:
    if one not in states or other not in states:
        return float("nan")
    return states[other] - states[one]


def _stated(covariance: Sequence[float] | FloatArray) -> FloatArray:
    variance = np.diag(np.array(covariance, dtype=float).reshape(6, 6))[list(_IN_PLANE)]
    result: FloatArray = np.sqrt(np.maximum(variance, 0.0))
    return result


def _sensed(message: Any, width: float, layout: CellLayout) -> FoundDoor:
    door = sensed_door_of(message)
    offset = layout.offset_of(door.T_base_door, width)
    told, seen = np.array([offset.y, offset.z, offset.rotation]), np.array(door.sees)[list(_IN_PLANE)]
    return FoundDoor(np.where(seen, told, np.nan), _stated(door.covariance))
