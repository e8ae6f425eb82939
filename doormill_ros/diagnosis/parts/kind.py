"""Inspected doors: points and bag of each become deviations that question robot, tool, force and place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.catalogue.known_bags import known_bag
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.diagnosis.core.changes import (
    STEP,
    change_sentences,
    changes_document,
    changes_of,
    diagnosed_at,
)
from doormill_ros.diagnosis.core.kind import Progress, SearchedKind
from doormill_ros.diagnosis.core.telling.account import Account, account_of
from doormill_ros.diagnosis.core.words.verdict import PARTLY_EXPLAINED
from doormill_ros.diagnosis.core.words.wording import Words
from doormill_ros.diagnosis.parts.correction.in_use import in_use_document
from doormill_ros.diagnosis.parts.correction.model import door_model_document, usable
from doormill_ros.diagnosis.parts.correction.standing import level_left
from doormill_ros.diagnosis.parts.correction.warming import warmed
from doormill_ros.diagnosis.parts.doors.gauged_door import GaugedDoor
from doormill_ros.diagnosis.parts.doors.matching import matched_points
from doormill_ros.diagnosis.parts.doors.recorded_cut import RecordedCut, recorded_cut
from doormill_ros.diagnosis.parts.fitting.cancelling import with_cancelling
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis, DoorProblem
from doormill_ros.diagnosis.parts.fitting.slips import BESIDE, FAR, slips, slips_beside
from doormill_ros.diagnosis.parts.fitting.steps import possible_steps
from doormill_ros.diagnosis.parts.telling.charts import charts_of
from doormill_ros.diagnosis.parts.telling.next_door import PLACES, checks_of, next_steps
from doormill_ros.diagnosis.parts.telling.next_step import next_document, next_sentence
from doormill_ros.diagnosis.parts.telling.without_name import (
    asked_beside,
    laws_of,
    unnamed_document,
    unnamed_sentences,
)
from doormill_ros.distributions import chi2_sf
from doormill_ros.localization.camera import load_camera
from doormill_ros.measurements.inspections.inspection import CAMERA, Inspection, inspections_in
from doormill_ros.pages.page import PageSection
from doormill_ros.robot.description import load_robot
from doormill_ros.units import m_to_mm

METHOD = """Where the tool cut, the bag knows posture, last motions and process wrench, and where the tool had been
sent: the deviation of a surface less that is the tool's displacement along its normal. Every effect of the library was
fitted alone and in combination, always of one size, beginning at a door, changing at one, or drifting (a force drifting
and changing, too), and scored on features or stretches left out of its fit. What a door's place could make counts no
more than that place is known."""


#: That noise leaves as much, or that doors stand as differently, where nothing hides behind their places.
_CHANCE = 1e-4
#: Times that slips are looked for beside what was found: without the largest others show.
_ROUNDS = 3


@dataclass(frozen=True, eq=False)
class InspectedDoor:
    """An inspection and what its points, matched with the run, tell.

    Attributes:
        inspection: The points.
        door: What they tell.
        slipped: Rows at which the gauge slipped, counted from 1.
    """

    inspection: Inspection
    door: GaugedDoor
    slipped: tuple[int, ...] = ()


class Inspections(SearchedKind[InspectedDoor, DoorProblem, InTime]):
    """Inspected doors of the robot in the cell, taken together.

    Args:
        in_use: Robot or model.yaml that the next door is corrected with, "" for the robot's joint springs; None where
            nobody asks what it leaves.
    """

    words = Words("simulation", "points", "deviation", "deviation", "features", METHOD)

    def __init__(self, in_use: str | None = None) -> None:
        self._in_use = in_use

    def read(self, folder: Path, progress: Progress) -> Sequence[InspectedDoor]:
        """One inspection, or those in a folder, each matched with the run that milled its door.

        Raises:
            DataSetError: An inspection cannot be read or does not belong to its bag.
            BagError: A bag cannot be read.
        """
        found = []
        for inspection in inspections_in(folder, known_bag):
            progress(f"matching {inspection.name} with the run that milled it")
            found.append(inspected_door(inspection, recorded_cut(inspection)))
        return found

    def problem(self, sets: Sequence[InspectedDoor]) -> DoorProblem:
        """The points of all doors."""
        layout = load_layout()
        return DoorProblem([one.door for one in sets], load_robot(layout.robot), layout.T_flange_tool)

    def diagnose(self, sets: Sequence[InspectedDoor], progress: Progress) -> DoorDiagnosis:
        """Look for doors at which something changed, then search, examine and weigh.

        Where something is left that no cause names, they are asked once more beside what every door may show alike.
        """
        return asked_beside(self._asked(self.problem(sets), progress), self._asked, progress)

    def _asked(self, problem: DoorProblem, progress: Progress) -> DoorDiagnosis:
        """What is said of the doors; of few others no change where something is left."""
        found = with_cancelling(self._told(problem, progress))
        changed = [finding.cause for finding in found.findings if finding.cause.course.steps]
        if problem.few_others and found.verdict == PARTLY_EXPLAINED and changed:
            return found.less(changed, "of so few doors, no two alike, what is left may look like a change")
        return found

    def _told(self, problem: DoorProblem, progress: Progress) -> DoorDiagnosis:
        """Look for steps, search, examine and weigh, again where slips or the doors' places make that necessary.

        How far doors scatter is seen by what the model in question leaves. Where what was found shows that they scatter
        less, and then leaves more than chance, or places that differ by more or show another step, something hid behind
        their places: the doors are asked once more.
        """
        found = diagnosed_at(problem, possible_steps(problem), progress)
        for _ in range(_ROUNDS):
            beside = slips_beside(found)
            if not beside.any():
                break
            progress(f"{beside.sum()} slips of the gauge: asking without them")
            problem = problem.without(beside)
            found = diagnosed_at(problem, possible_steps(problem), progress)
        again = problem.placed_by(found.best.members, found.best.theta)
        best = found.best
        white = again.predict(best.members, best.theta).white[best.weights > 0.0]
        leaves_chance = min(chi2_sf(np.sum(white**2), len(white)), again.door_places.chance) > _CHANCE
        if leaves_chance and again.door_places.step == 0:
            return found
        progress("the doors scatter less than it seemed: asking once more")
        steps = {*possible_steps(again), *_steps_in(found)}
        return diagnosed_at(again, tuple(sorted(steps)), progress)

    def name(self, one: InspectedDoor) -> str:
        """What the door is called."""
        return one.inspection.name

    def account(
        self,
        diagnosis: DoorDiagnosis,
        sets: Sequence[InspectedDoor],
        checks: Sequence[Mapping[str, Any]],
        progress: Progress,
    ) -> Account:
        """With what changed since which door, charts, and a model for the path generator."""
        progress("asking since when")
        changes = changes_of(diagnosis)
        laws = laws_of(diagnosis)
        charts = charts_of(diagnosis, min((c.door for c in changes if c.kind == STEP), default=None))
        remarks = [
            *change_sentences(diagnosis, changes),
            *unnamed_sentences(diagnosis, laws),
            *_scope(diagnosis),
            *_slipped(diagnosis, sets),
        ]
        steps = next_steps(diagnosis)
        told = next_sentence(steps, checks_of(diagnosis.problem.effects()))
        account = account_of(diagnosis, self.words, told, checks)
        sections = (
            _facts(diagnosis, sets)
            | unnamed_document(diagnosis, laws)
            | {
                "changes": changes_document(diagnosis, changes),
                "charts": charts.document(),
                "next": next_document(steps),
            }
        )
        if self._in_use is not None:
            level = level_left(diagnosis)
            first = max([*(change.door for change in changes), 0 if level is None else level.since])
            sections["in_use"] = in_use_document(diagnosis, self._in_use, first)
        names = [one.name for one in diagnosis.problem.doors]
        source = names[0] if len(names) == 1 else f"{names[0]} to {names[-1]}"
        return replace(
            account,
            sections=sections,
            remarks=[*remarks, *account.remarks],
            model=door_model_document(diagnosis, source),
            closing=[PageSection("Door by door", charts.blocks())],
        )


def _steps_in(diagnosis: DoorDiagnosis) -> list[int]:
    """Doors at which a cause of the best model begins or changes: once found, a look at what is left shows no more."""
    times = [door.time for door in diagnosis.problem.doors]
    return [times.index(member.course.at) for member in diagnosis.best.members if member.course.steps]


def _scope(diagnosis: DoorDiagnosis) -> list[str]:
    """What these doors cannot tell, and what of it the path generator cannot undo."""
    found, places = [], diagnosis.problem.places
    if places < PLACES:
        found.append(
            f"The features lie in {places} place{'s' if places > 1 else ''} of the cell; which joint gives way is told "
            f"by {PLACES} or more."
        )
    _, others = usable(diagnosis)
    if others:
        found.append(f"No correction of the path undoes {' and '.join(others)}: put that right where it is.")
    level = level_left(diagnosis)
    if level is not None:
        began = f" from {diagnosis.problem.doors[level.since].name} on" if level.since else ""
        found.append(
            f"Beside what is named, doors stand {m_to_mm(level.size):.2f} mm elsewhere than they were seen{began}: the "
            f"path generator undoes that, whatever the cause."
        )
    if any(warmed(finding) for finding in diagnosis.findings):
        found.append(
            "The path generator undoes the growth by the time that it has seen its cell work: after its own start or a "
            "pause it takes the cell for colder than it may be, and undoes less."
        )
    return found


def _slipped(diagnosis: DoorDiagnosis, sets: Sequence[InspectedDoor]) -> list[str]:
    """Which points were set aside."""
    left = {(door.run_id, door.name): door.points.row for door in diagnosis.problem.doors}
    found = []
    for one in sets:
        rows = one.door.points.row
        later = rows[~np.isin(rows, left[one.door.run_id, one.door.name])] + 1
        if one.slipped or len(later):
            found.append(f"{one.door.name}: {', '.join(map(str, sorted([*one.slipped, *later.tolist()])))}")
    if not found:
        return []
    return [
        f"Rows of points that lie more than {m_to_mm(BESIDE):g} mm beside their neighbours, or {FAR:g} standard "
        f"deviations beside what was found, are slips of the gauge and count nowhere: {'; '.join(found)}."
    ]


def inspected_door(inspection: Inspection, cut: RecordedCut) -> InspectedDoor:
    """An inspection joined with the run that milled its door in the cell of the layout.

    Raises:
        TrialTableError: A point belongs to no feature of the recipe, or too many lie beside their neighbours.
        SetDescriptionError: No point was cut under one load.
    """
    layout, slipped = load_layout(), slips(inspection)
    robot = load_robot(layout.robot)
    door = GaugedDoor(
        name=inspection.name,
        run_id=inspection.run_id,
        recipe=cut.recipe.door_id,
        time=inspection.measured_at.timestamp(),
        points=matched_points(inspection, cut, robot, layout.T_flange_tool, slipped),
        noise=inspection.noise,
        placing=cut.placing if inspection.datum == CAMERA else None,
        T_base_door=cut.T_base_door,
        eye=load_camera().T_base_camera(cut.recipe.width)[:3, 3],
        largest=float(np.abs(inspection.deviation[~slipped]).max()),
        milled=cut.milled,
        robot_model=cut.robot_model,
    )
    return InspectedDoor(inspection, door, tuple(int(row) + 1 for row in np.flatnonzero(slipped)))


def _outliers(diagnosis: DoorDiagnosis) -> dict[str, list[int]]:
    """Rows that are gross errors beside the model that was found, counted from 1, by the name of their inspection."""
    problem, gross = diagnosis.problem, ~diagnosis.kept
    found: dict[str, list[int]] = {}
    for number, door in enumerate(problem.doors):
        rows = problem.points.row[gross & (problem.door == number)] + 1
        if len(rows):
            found[door.name] = sorted([*found.get(door.name, []), *map(int, rows)])
    return found


def _facts(diagnosis: DoorDiagnosis, sets: Sequence[InspectedDoor]) -> dict[str, Any]:
    inspections = [one.inspection for one in sets]
    used = sum(len(door.points) for door in diagnosis.problem.doors)
    return {
        "inspections": [
            {"run_id": one.run_id, "measured_at": one.measured_at.isoformat()} for one in inspections
        ],
        "points": {
            "measured": sum(len(one) for one in inspections),
            "on_floors": sum(int(np.sum(~one.wall)) for one in inspections),
            "slips": sum(len(one.slipped) + len(one.door.points) for one in sets) - used,
            "used": used,
        },
        "outliers_by_inspection": _outliers(diagnosis),
    }
