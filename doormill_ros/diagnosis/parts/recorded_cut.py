"""What the bag of an inspected door says of the run that milled it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.measurements.inspection import Inspection
from doormill_ros.messages.from_message import recipe_of, seconds_of, transform_of, transforms_of, wrench_of
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recording.bag_reader import read_bag, topics_of

EXECUTED_PATH, LOCALIZATION, RECIPE = "/simulation/executed_path", "/door/localization", "/door/recipe"
RESULT = "/run/result"
_TOPICS = (EXECUTED_PATH, LOCALIZATION, RECIPE, RESULT)
#: Of y, z and the rotation about x in the covariance of a pose.
_IN_PLANE = (1, 2, 3)


@dataclass(frozen=True, eq=False)
class RecordedCut:
    """What the bag says of the run that milled a door.

    Attributes:
        recipe: The door.
        T_base_door: Where the localizer put it, shape (4, 4).
        placing: Covariance of y, z and rotation about base x of that, shape (3, 3) [m, m, rad].
        tool: Commanded poses of the tool in base, shape (m, 4, 4).
        q: Commanded joint angles, shape (m, 6) [rad].
        wrench: On the tool at its centre point, base axes, shape (m, 6) [N, N m].
        time: Shape (m,) [s].
        cutting: Samples in the wood, shape (m,).
        feature: Name of the feature of each sample.
        milled: When the tool set out [s since the epoch]; None for a message without a stamp.
        robot_model: That the path was corrected with; "" where the run is older than that its end tells it.
    """

    recipe: Recipe
    T_base_door: FloatArray
    placing: FloatArray
    tool: FloatArray
    q: FloatArray
    wrench: FloatArray
    time: FloatArray
    cutting: BoolArray
    feature: tuple[str, ...]
    milled: float | None = None
    robot_model: str = ""


def recorded_cut(inspection: Inspection) -> RecordedCut:
    """What the bag of an inspection says of its run.

    Raises:
        SetDescriptionError: The bag does not hold that run, its pose or its executed path.
        BagError: The bag cannot be read.
    """
    names = [topic for topic in topics_of(inspection.bag) if topic.endswith(_TOPICS)]
    found: dict[str, dict[str, Any]] = {}
    for item in read_bag(inspection.bag, names) if names else ():
        kind = next(end for end in _TOPICS if item.topic.endswith(end))
        if kind != LOCALIZATION or item.message.accepted:
            found.setdefault(item.message.run_id, {})[kind] = item.message
    run = found.get(inspection.run_id, {})
    if RECIPE not in run:
        runs = [run_id for run_id, messages in found.items() if RECIPE in messages]
        raise inspection.refuse("run_id", f"is {inspection.run_id!r}, the bag holds {', '.join(runs)}")
    for kind, words in ((LOCALIZATION, "door pose"), (EXECUTED_PATH, f"path on {EXECUTED_PATH}")):
        if kind not in run:
            raise inspection.refuse("bag", f"names a bag that holds no {words} of run {inspection.run_id}")
    path, pose = run[EXECUTED_PATH], run[LOCALIZATION].pose
    covariance = np.array(pose.covariance, dtype=float).reshape(6, 6)
    return RecordedCut(
        recipe=recipe_of(run[RECIPE]),
        T_base_door=transform_of(pose.pose),
        placing=covariance[np.ix_(_IN_PLANE, _IN_PLANE)],
        tool=transforms_of(path.commanded),
        q=np.array(path.joint_positions, dtype=float).reshape(-1, 6),
        wrench=np.array([wrench_of(wrench) for wrench in path.wrench]),
        time=np.array(path.time, dtype=float),
        cutting=np.array(path.cutting, dtype=bool),
        feature=tuple(path.feature),
        milled=seconds_of(path.header.stamp) or None,
        robot_model=str(getattr(run.get(RESULT), "robot_model", "")),
    )
