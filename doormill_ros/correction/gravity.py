"""The weight that a cell tells of, in the model by which its targets are corrected."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.errors import BadCellFile
from doormill_ros.cell.places.gravity import Gravity
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import ComplianceModel, StandingModel
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel
from doormill_ros.robot_model.gravity.model import SaggingModel
from doormill_ros.robot_model.gravity.sag import GravitySag
from doormill_ros.robot_model.gravity.weights import FLANGE, Weight


def with_gravity(model: ComplianceModel, robot: Robot, gravity: Gravity) -> ComplianceModel:
    """The model with the sag under the weights that the cell tells of; the model itself where it tells none.

    A model from poses stays as it is: the poses were measured on a robot that sagged.

    Args:
        model: How the robot gives way.
        robot: With the masses of its links.
        gravity: Of the cell.

    Raises:
        BadCellFile: The load is more than the robot carries, or the links' masses are wanted and nobody stated them.
    """
    weights = weights_of(robot, gravity)
    if not weights or isinstance(model, StandingModel):
        return model
    taught = np.array([list(q) for q in gravity.taught]).reshape(-1, 6)
    return SaggingModel(model, GravitySag(Kinematics(robot), _springs(model, robot), weights, taught))


def weights_of(robot: Robot, gravity: Gravity) -> list[Weight]:
    """What counts of tool and links.

    Args:
        robot: With the masses of its links.
        gravity: Of the cell.

    Raises:
        BadCellFile: See `with_gravity`.
    """
    weights = []
    if gravity.links:
        links = robot.links
        if links is None:
            raise BadCellFile(
                f"gravity.links is true, but nobody stated what the links of {robot.label} weigh: add links to "
                f"config/robots/{robot.name}/robot.yaml, or set gravity.links to false"
            )
        weights += [
            Weight(
                k + 1,
                float(links.mass[k]),
                float(links.std[k]),
                links.centre[k],
                1.0 - links.balanced,
                links.balanced_std,
            )
            for k in range(FLANGE)
        ]
    load = gravity.tool_load
    if load is not None:
        if load.mass > robot.payload:
            raise BadCellFile(
                f"gravity.tool_load.mass is {load.mass:g} kg, {robot.label} carries {robot.payload:g} kg at most; "
                "state kilograms, or take another robot"
            )
        weights.append(Weight(FLANGE, load.mass, load.std, load.centre, np.ones(6), np.zeros(6)))
    return weights


def _springs(model: ComplianceModel, robot: Robot) -> FloatArray:
    return model.springs_of_joints() if isinstance(model, ExtendedComplianceModel) else robot.stiffness
