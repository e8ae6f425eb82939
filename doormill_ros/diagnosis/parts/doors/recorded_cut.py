"""What the bag of an inspected door says of the run that milled it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.graph.topic_names import (
    DOOR_LOCALIZATION,
    DOOR_RECIPE,
    EXECUTED_PATH,
    PATH_TARGETS,
    RUN_RESULT,
    name_of,
)
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.measurements.inspections.inspection import Inspection
from doormill_ros.messages.from_message import (
    program_of,
    recipe_of,
    transform_of,
    transforms_of,
    wrenches_of,
)
from doormill_ros.messages.stamps import seconds_of
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recording.bag_reader import read_bag, topics_of
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.toolpath.commanded_path import CommandedPath, commanded_path

_TOPICS = (EXECUTED_PATH, PATH_TARGETS, DOOR_LOCALIZATION, DOOR_RECIPE, RUN_RESULT)
#: Of y, z and the rotation about x in the covariance of a pose.
_IN_PLANE = (1, 2, 3)


@dataclass(frozen=True, eq=False, kw_only=True)
class RecordedCut(CommandedPath):
    """What the bag says of the run that milled a door.

    A simulated controller tells where it sent the tool. A real one tells nothing: there its targets do.

    Attributes:
        recipe: The door.
        T_base_door: Where the localizer put it, shape (4, 4).
        placing: Covariance of y, z and rotation about base x of that, shape (3, 3) [m, m, rad].
        milled: When the tool set out [s since the epoch]; None for a message without a stamp.
        robot_model: That the path was corrected with; "" where the run is older than that its end tells it.
    """

    recipe: Recipe
    T_base_door: FloatArray
    placing: FloatArray
    milled: float | None = None
    robot_model: str = ""


def recorded_cut(inspection: Inspection) -> RecordedCut:
    """What the bag of an inspection says of its run.

    Raises:
        SetDescriptionError: The bag does not hold that run, its pose or its path.
        BagError: The bag cannot be read.
    """
    names = [topic for topic in topics_of(inspection.bag) if name_of(topic, _TOPICS)]
    found: dict[str, dict[str, Any]] = {}
    for item in read_bag(inspection.bag, names) if names else ():
        kind = name_of(item.topic, _TOPICS)
        if kind not in (DOOR_LOCALIZATION, PATH_TARGETS) or item.message.accepted:
            found.setdefault(item.message.run_id, {})[kind] = item.message
    run = found.get(inspection.run_id, {})
    if DOOR_RECIPE not in run:
        runs = [run_id for run_id, messages in found.items() if DOOR_RECIPE in messages]
        raise inspection.refuse("run_id", f"is {inspection.run_id!r}, the bag holds {', '.join(runs)}")
    for kinds, words in (
        ((DOOR_LOCALIZATION,), "door pose"),
        ((EXECUTED_PATH, PATH_TARGETS), f"path on /{PATH_TARGETS} or /{EXECUTED_PATH}"),
    ):
        if not any(kind in run for kind in kinds):
            raise inspection.refuse("bag", f"names a bag that holds no {words} of run {inspection.run_id}")
    path, message = _path(run)
    pose = run[DOOR_LOCALIZATION].pose
    covariance = np.array(pose.covariance, dtype=float).reshape(6, 6)
    return RecordedCut(
        recipe=recipe_of(run[DOOR_RECIPE]),
        T_base_door=transform_of(pose.pose),
        placing=covariance[np.ix_(_IN_PLANE, _IN_PLANE)],
        **vars(path),
        milled=seconds_of(message.header.stamp) or None,
        robot_model=str(getattr(run.get(RUN_RESULT), "robot_model", "")),
    )


def _path(run: Mapping[str, Any]) -> tuple[CommandedPath, Any]:
    """Where the tool was sent, and the message that tells it."""
    if EXECUTED_PATH not in run:
        layout = load_layout()
        kinematics = Kinematics(load_robot(layout.robot))
        program = program_of(run[PATH_TARGETS])
        return commanded_path(program, kinematics, layout.T_flange_tool), run[PATH_TARGETS]
    told = run[EXECUTED_PATH]
    path = CommandedPath(
        tool=transforms_of(told.commanded),
        q=np.array(told.joint_positions, dtype=float).reshape(-1, 6),
        wrench=wrenches_of(told.wrench),
        time=np.array(told.time, dtype=float),
        cutting=np.array(told.cutting, dtype=bool),
        feature=tuple(told.feature),
    )
    return path, told
