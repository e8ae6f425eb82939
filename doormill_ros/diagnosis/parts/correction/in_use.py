"""What the model in use leaves of the inspected doors, and what the model that was found would leave.

A correction sends the tool against the displacement that its model predicts, or against the share of it that the
prediction is worth. With another model a door would have come out by the difference of what the two undo otherwise,
wherever the tool cut.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.correction.loaded_robot import LoadedRobot
from doormill_ros.correction.worth import worth_of
from doormill_ros.diagnosis.parts.correction.model import door_model
from doormill_ros.diagnosis.parts.doors.cut_points import CutPoints
from doormill_ros.diagnosis.parts.doors.gauged_door import GaugedDoor
from doormill_ros.diagnosis.parts.fitting.placement import free_columns
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis
from doormill_ros.errors import DoormillError
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import ComplianceModel
from doormill_ros.robot_model.extended_model import load_model_of, standing_model
from doormill_ros.robot_model.warmth.grown_model import grown, growth_in
from doormill_ros.statistics import root_mean_square
from doormill_ros.toolpath.settings import load_settings
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
    robot, doors, tool = diagnosis.problem.robot, diagnosis.problem.doors, diagnosis.problem.tool
    late = doors[first:]

    def undone(cold: ComplianceModel) -> list[FloatArray]:
        warm = [_when_milled(cold, robot, doors[0], door) for door in late]
        return [undone_along(door.points, one, robot, tool) for door, one in zip(late, warm, strict=True)]

    used = undone(load_model_of(robot, model))
    found = undone(standing_model(robot, door_model(diagnosis)))
    milled = [_undone_of(door, robot, tool) for door in late]

    def errors(wanted: Sequence[FloatArray]) -> list[float]:
        return [_error(*each) for each in zip(late, milled, wanted, strict=True)]

    return {
        "model": model,
        "expected_error": _expected(late, errors(used)),
        "expected_error_extended": _expected(late, errors(found)),
        "difference": root_mean_square(np.concatenate(used) - np.concatenate(found)),
    }


def undone_along(
    points: CutPoints, model: ComplianceModel, robot: Robot, T_flange_tool: FloatArray
) -> FloatArray:
    """What a plan with a model undoes at each point along its normal, shape (n,) [m].

    Args:
        points: n of them.
        model: How the robot gives way, as warm as it is.
        robot: That mills.
        T_flange_tool: Its tool, shape (4, 4).
    """
    worth = worth_of(robot, load_settings().correction.unmeasured, model)
    loaded = LoadedRobot(Kinematics(robot), model, T_flange_tool, worth=worth)
    twist = loaded.undone(points.q, points.loads)(points.q)
    return np.asarray(np.sum(points.normal * twist[:, :3], axis=1))


def _when_milled(cold: ComplianceModel, robot: Robot, first: GaugedDoor, door: GaugedDoor) -> ComplianceModel:
    """A model as warm as a cell that has worked since its first door was when it milled another one."""
    growth = growth_in(cold)
    if growth is None:
        return cold
    hours = (door.time - first.time) / hours_to_s(1.0)
    return grown(cold, Kinematics(robot), growth, *growth.after(hours))


def _undone_of(door: GaugedDoor, robot: Robot, tool: FloatArray) -> FloatArray:
    """What the correction of a door undid at its points along their normals, shape (n,) [m].

    Of one that is no longer there, or of which nobody knows how warm it was, only what it sent is known.
    """
    try:
        model = load_model_of(robot, door.robot_model)
    except DoormillError:
        return -door.points.sent
    if growth_in(model) is not None:
        return -door.points.sent
    return undone_along(door.points, model, robot, tool)


def _error(door: GaugedDoor, milled: FloatArray, wanted: FloatArray) -> float:
    """How far the worst point of a door would be off, had its correction undone something else [m].

    The difference is known where it is known what cut a point; elsewhere the worst point is taken to follow.
    """
    points = door.points
    off = points.deviation + milled - wanted
    if door.placing is None:
        columns = free_columns(points.point, points.normal)
        off = off - columns @ np.linalg.lstsq(columns, off, rcond=1e-6)[0]
        return float(np.abs(off).max())
    known = float(np.abs(points.deviation).max())
    return float(np.abs(off).max()) + max(door.largest - known, 0.0)


def _expected(doors: Sequence[GaugedDoor], each: Sequence[float]) -> float:
    """Mean error of the last doors of a recipe, of the worst recipe [m]."""
    errors: dict[str, list[float]] = {}
    for door, error in zip(doors, each, strict=True):
        errors.setdefault(door.recipe, []).append(error)
    return max(float(np.mean(of_recipe[-LAST:])) for of_recipe in errors.values())
