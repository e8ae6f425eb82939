"""Errors of the robot description and its kinematics."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class RobotError(DoormillError):
    """Something about a robot that the input got wrong."""

    code = 700


class GeometryError(RobotError):
    """The robot's axes are not those of a lower arm in one plane with a spherical wrist."""

    code = 702


class UnreachableError(RobotError):
    """No joint angles at all reach a pose."""

    code = 703


class JointLimitError(RobotError):
    """A pose can be reached only with joints beyond their limits."""

    code = 704


class SingularityError(RobotError):
    """A path passes closer to a singularity than allowed."""

    code = 705


class BranchError(RobotError):
    """Each pose can be reached, but no one configuration keeps to the whole path."""

    code = 706


RobotDescriptionError = RobotError.row(
    "RobotDescriptionError", 701, "A robot's URDF or YAML is missing or wrong."
)
