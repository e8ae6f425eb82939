"""Errors of the robot description and its kinematics.

RobotError 700
|-- RobotDescriptionError 701    files that do not describe a usable six-axis robot
|-- GeometryError 702            the robot has no closed-form inverse here
|-- UnreachableError 703         a pose lies outside the reach
|-- JointLimitError 704          a pose is reachable only beyond the joint limits
|-- SingularityError 705         a path passes too close to a singularity
`-- BranchError 706              no single configuration serves a whole path
"""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class RobotError(DoormillError):
    """Something about a robot that the input got wrong."""

    code = 700


class RobotDescriptionError(RobotError):
    """The URDF or YAML of a robot is missing, unreadable or contradicts itself."""

    code = 701


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
