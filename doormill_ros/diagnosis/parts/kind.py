"""Inspected doors: points and bag of each become contours that question the robot's joint springs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.cell.layout import load_layout
from doormill_ros.diagnosis.core.account import Account, account_of
from doormill_ros.diagnosis.core.kind import Progress, SearchedKind
from doormill_ros.diagnosis.core.wording import Words
from doormill_ros.diagnosis.loading.kind import extended_model_document
from doormill_ros.diagnosis.loading.problem import LoadingDiagnosis, LoadingProblem
from doormill_ros.diagnosis.parts.inspection import InspectedContour, match_contour, part_problem
from doormill_ros.frames import apply, inverse
from doormill_ros.measurements.inspection import CAMERA, FEATURE, SCHEMA, Inspection, inspections_in
from doormill_ros.messages.from_message import recipe_of, transform_of, wrench_of
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recording.bag_reader import read_bag, topics_of
from doormill_ros.recording.replay.recorded_run import read_runs
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause

EXECUTED_PATH = "/simulation/executed_path"

METHOD = """Where the tool cut, the bag knows posture, last motions and process wrench, and where the tool had been
sent: the deviation of the wall less that is the robot's displacement under load along the wall's normal. It was
questioned as a loading test is, on stretches of wall left out of every fit."""


@dataclass(frozen=True, eq=False)
class RecordedCut:
    """What the bag says of the run that milled a door.

    Attributes:
        recipe: The door.
        T_base_door: Where the localizer put it, shape (4, 4).
        tool: Commanded poses of the tool in base, shape (m, 4, 4).
        q: Commanded joint angles, shape (m, 6) [rad].
        wrench: On the tool at its centre point, base axes, shape (m, 6) [N, N m].
        time: Shape (m,) [s].
        cutting: Samples in the wood, shape (m,).
        feature: Name of the feature of each sample.
    """

    recipe: Recipe
    T_base_door: FloatArray
    tool: FloatArray
    q: FloatArray
    wrench: FloatArray
    time: FloatArray
    cutting: BoolArray
    feature: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class MatchedInspection:
    """An inspection and the contours that its points became."""

    inspection: Inspection
    contours: list[InspectedContour]


class Inspections(SearchedKind[MatchedInspection, LoadingProblem, ElasticCause]):
    """Inspected doors of the robot in the cell, taken together."""

    schema = SCHEMA
    option = "inspections"
    help = "one or many inspected doors"
    words = Words("simulation", "points", "deviation", "deviation", "stretches", METHOD)
    next_measurement = (
        "inspect doors whose features the robot reaches in other postures, on walls cut in both directions: contours "
        "of one posture cannot tell which joint gave way"
    )

    def read(self, folder: Path, progress: Progress) -> Sequence[MatchedInspection]:
        """One inspection, or those in a folder, each matched with the run that milled its door.

        Raises:
            DataSetError: An inspection cannot be read or does not belong to its bag.
            BagError: A bag cannot be read.
        """
        found = []
        for inspection in inspections_in(folder):
            progress(f"matching {inspection.name} with the run that milled it")
            found.append(
                MatchedInspection(inspection, matched_contours(inspection, recorded_cut(inspection)))
            )
        return found

    def problem(self, sets: Sequence[MatchedInspection]) -> LoadingProblem:
        """The walls of all doors, as a loading test of the robot in the cell."""
        layout = load_layout()
        noise = float(np.sqrt(np.mean([one.inspection.noise**2 for one in sets])))
        contours = [contour for one in sets for contour in one.contours]
        doors = [
            -1 if one.inspection.datum == CAMERA else number
            for number, one in enumerate(sets)
            for _ in one.contours
        ]
        return part_problem(contours, load_robot(layout.robot), layout.T_flange_tool, noise, doors)

    def name(self, one: MatchedInspection) -> str:
        """What the door is called."""
        return one.inspection.name

    def account(
        self,
        diagnosis: LoadingDiagnosis,
        sets: Sequence[MatchedInspection],
        checks: Sequence[Mapping[str, Any]],
        progress: Progress,
    ) -> Account:
        """With the inspections, how many of their points were used, and a model for the path generator."""
        source = ", ".join(map(self.name, sets))
        return replace(
            account_of(diagnosis, self.words, self.next_measurement, checks),
            sections=_facts(sets),
            model=extended_model_document(diagnosis, source),
        )


def _facts(sets: Sequence[MatchedInspection]) -> dict[str, Any]:
    inspections = [one.inspection for one in sets]
    return {
        "inspections": [
            {"run_id": one.run_id, "measured_at": one.measured_at.isoformat()} for one in inspections
        ],
        "points": {
            "measured": sum(len(one) for one in inspections),
            "on_floors": sum(int(np.sum(~one.wall)) for one in inspections),  # walls alone are questioned
            "used": sum(len(contour.deviation) for one in sets for contour in one.contours),
        },
    }


def recorded_cut(inspection: Inspection) -> RecordedCut:
    """What the bag of an inspection says of its run.

    Raises:
        SetDescriptionError: The bag does not hold that run, its pose or its executed path.
        BagError: The bag cannot be read.
    """
    runs = {run.run_id: run for run in read_runs(inspection.bag)}
    run = runs.get(inspection.run_id)
    if run is None or run.recipe is None:
        raise inspection.refuse("run_id", f"is {inspection.run_id!r}, the bag holds {', '.join(runs)}")
    poses = [message.pose.pose for _, message in run.localizations if message.accepted]
    topics = [topic for topic in topics_of(inspection.bag) if topic.endswith(EXECUTED_PATH)]
    executed = [
        item.message
        for item in (read_bag(inspection.bag, topics) if topics else ())
        if item.message.run_id == run.run_id
    ]
    if not poses or not executed:
        missing = "door pose" if not poses else f"path on {EXECUTED_PATH}"
        raise inspection.refuse("bag", f"names a bag that holds no {missing} of run {run.run_id}")
    path = executed[-1]
    return RecordedCut(
        recipe=recipe_of(run.recipe),
        T_base_door=transform_of(poses[-1]),
        tool=np.array([transform_of(pose) for pose in path.commanded]),
        q=np.array(path.joint_positions, dtype=float).reshape(-1, 6),
        wrench=np.array([wrench_of(wrench) for wrench in path.wrench]),
        time=np.array(path.time, dtype=float),
        cutting=np.array(path.cutting, dtype=bool),
        feature=tuple(path.feature),
    )


def matched_contours(inspection: Inspection, cut: RecordedCut) -> list[InspectedContour]:
    """The walls of an inspection with the robot's state where each point was cut, one contour a feature.

    Raises:
        TrialTableError: A point belongs to no feature of the recipe.
        SetDescriptionError: No point lies on a wall that was cut under steady load.
    """
    names = {feature.id for feature in cut.recipe.features}
    datum = inspection.datum.removeprefix(FEATURE)
    if datum != inspection.datum and datum not in names:
        raise inspection.refuse("datum", f"is against {datum!r}, the recipe has {', '.join(sorted(names))}")
    for row, name in enumerate(inspection.feature):
        if name not in names:
            raise inspection.refuse_point(
                row, "feature", f"is {name!r}, the recipe has {', '.join(sorted(names))}"
            )
    contours = []
    for feature in cut.recipe.features:
        rows = np.flatnonzero((np.array(inspection.feature) == feature.id) & inspection.wall)
        cutting = cut.cutting & (np.array(cut.feature) == feature.id)
        if not len(rows) or not np.any(cutting & np.any(cut.wrench != 0.0, axis=1)):
            continue
        # The flank of the deepest pass leaves the wall: its points are looked for at the depth of the tip there.
        T_base_feature = cut.T_base_door @ cut.recipe.T_door_feature(feature)
        depth = apply(inverse(T_base_feature), cut.tool[cutting, :3, 3])[:, 2].max()
        flat = apply(inverse(T_base_feature), apply(cut.T_base_door, inspection.point[rows]))
        flat[:, 2] = depth
        contours.append(
            match_contour(
                apply(T_base_feature, flat),
                inspection.normal[rows] @ cut.T_base_door[:3, :3].T,
                inspection.deviation[rows],
                tool_radius=feature.tool.radius,
                tool=cut.tool[:, :3, 3],
                q=cut.q,
                wrench=cut.wrench,
                time=cut.time,
                cutting=cutting,
            )
        )
    contours = [contour for contour in contours if len(contour.deviation)]
    if not contours:
        raise inspection.refuse("run_id", "names a run that cut none of the measured walls under steady load")
    return contours
