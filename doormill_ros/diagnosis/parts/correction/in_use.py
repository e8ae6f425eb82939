"""What the model in use leaves of the inspected doors, and what the model that was found would leave.

A correction sends the tool against the displacement that its model predicts. With another model a door would have
come out by the difference of the two predictions otherwise, wherever the tool cut.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.parts.correction.model import usable
from doormill_ros.diagnosis.parts.correction.standing import standing_of
from doormill_ros.diagnosis.parts.correction.warming import growth_told
from doormill_ros.diagnosis.parts.doors.cut_points import CutPoints
from doormill_ros.diagnosis.parts.doors.gauged_door import GaugedDoor
from doormill_ros.diagnosis.parts.fitting.placement import free_columns
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis
from doormill_ros.errors import DoormillError
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import ComplianceModel
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel, load_model_of, standing_model
from doormill_ros.robot_model.warmth.grown_model import grown, growth_in
from doormill_ros.statistics import root_mean_square
from doormill_ros.units import hours_to_s

LAST = 3  #: doors of a recipe by which its next one is judged


def in_use_document(diagnosis: DoorDiagnosis, model: str, first: int) -> dict[str, Any]:
    """What diagnosis.json says of the model in use.

    Args:
        diagnosis: Of inspected doors.
        model: Robot or model.yaml that the next door is corrected with; "" for the robot's joint springs.
        first: Number of the first door that tells of the next one: before it something else held.

    Raises:
        ExtendedModelError: The model cannot be used.
    """
    robot, doors = diagnosis.problem.robot, diagnosis.problem.doors
    causes, place = usable(diagnosis)[0], standing_of(diagnosis)
    extended = ExtendedComplianceModel(
        robot.name, robot.dh, robot.stiffness, causes, place=place, growth=growth_told(diagnosis)
    )
    tip, late = diagnosis.problem.tool[:3, 3], doors[first:]

    def warm(cold: ComplianceModel) -> list[ComplianceModel]:
        return [_when_milled(cold, robot, doors[0], door) for door in late]

    used, found = warm(load_model_of(robot, model)), warm(standing_model(robot, extended))
    moved = [
        _along(door.points, one, tip) - _along(door.points, other, tip)
        for door, one, other in zip(late, used, found, strict=True)
    ]

    def errors(models: Sequence[ComplianceModel]) -> list[float]:
        pairs = zip(late, models, strict=True)
        return [_error(door, _milled_with(door, robot), wanted, tip) for door, wanted in pairs]

    return {
        "model": model,
        "expected_error": _expected(late, errors(used)),
        "expected_error_extended": _expected(late, errors(found)),
        "difference": root_mean_square(np.concatenate(moved)),
    }


def _when_milled(cold: ComplianceModel, robot: Robot, first: GaugedDoor, door: GaugedDoor) -> ComplianceModel:
    """A model as warm as a cell that has worked since its first door was when it milled another one."""
    growth = growth_in(cold)
    if growth is None:
        return cold
    hours = (door.time - first.time) / hours_to_s(1.0)
    return grown(cold, Kinematics(robot), growth, *growth.after(hours))


def _milled_with(door: GaugedDoor, robot: Robot) -> ComplianceModel | None:
    """The model that a door was corrected with; None where it is no longer there, or nobody knows how warm it was."""
    try:
        model = load_model_of(robot, door.robot_model)
    except DoormillError:
        return None
    return model if growth_in(model) is None else None


def _error(
    door: GaugedDoor, milled: ComplianceModel | None, wanted: ComplianceModel, tip: FloatArray
) -> float:
    """How far the worst point of a door would be off, had it been corrected with another model [m].

    The difference is known where it is known what cut a point; elsewhere the worst point is taken to follow.
    """
    points = door.points
    # Of a correction that nobody knows any more only what it sent is known, and none is perfect.
    before = -points.sent if milled is None else _along(points, milled, tip)
    off = points.deviation + before - _along(points, wanted, tip)
    if door.placing is None:
        columns = free_columns(points.point, points.normal)
        off = off - columns @ np.linalg.lstsq(columns, off, rcond=1e-6)[0]
        return float(np.abs(off).max())
    known = float(np.abs(points.deviation).max())
    return float(np.abs(off).max()) + max(door.largest - known, 0.0)


def _along(points: CutPoints, model: ComplianceModel, tip: FloatArray) -> FloatArray:
    """What a model moves each point along its normal, shape (n,) [m]."""
    twist = model.deflection(points.q, points.wrench, tip, points.direction)
    return np.asarray(np.sum(points.normal * twist[:, :3], axis=1))


def _expected(doors: Sequence[GaugedDoor], each: Sequence[float]) -> float:
    """Mean error of the last doors of a recipe, of the worst recipe [m]."""
    errors: dict[str, list[float]] = {}
    for door, error in zip(doors, each, strict=True):
        errors.setdefault(door.recipe, []).append(error)
    return max(float(np.mean(of_recipe[-LAST:])) for of_recipe in errors.values())
