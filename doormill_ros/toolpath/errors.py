"""Errors of toolpaths, their correction and the whole-door checks.

PathError 300
|-- PathSettingsError 301       config/toolpath.yaml holds an impossible value
|-- DoorPoseError 302           the door stands outside the placement limits
|-- NothingToMillError 303      the recipe, or a robot's share of it, holds no feature
|-- ProgramSizeError 304        more targets than a controller keeps
|-- ToolFitError 305            the tool is too wide or too short for a feature
|-- ArcError 306                an arc that no MoveC can follow
|-- ToolChangeError 307         one robot's features need more tools than it has
|-- ReachError 310              a target lies outside the reach
|-- PathJointLimitError 311     a target needs a joint beyond its limit
|-- PathSingularityError 312    the path passes too close to a singularity
|-- ConfigurationChangeError 313  no single robot configuration serves a feature
|-- JointSpeedError 314         the feed asks a joint for more than its speed
|-- AirMoveError 315            a way through the air touches the door
|-- HolderError 316             the spindle would meet the surface over a deep pocket
|-- CorrectionLimitError 320    the robot bends further than may be corrected
|-- CorrectionSettleError 321   the correction does not settle
`-- CycleTimeError 330          the program is slower than the cell's cycle
"""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class PathError(DoormillError):
    """No milling program can be made, and the sentence says why."""

    code = 300


class PathSettingsError(PathError):
    """A setting of the path generator is impossible."""

    code = 301


class DoorPoseError(PathError):
    """The door stands where the cell does not mill."""

    code = 302


class NothingToMillError(PathError):
    """There is no feature to mill."""

    code = 303


class ProgramSizeError(PathError):
    """The program has more targets than a controller keeps."""

    code = 304


class ToolFitError(PathError):
    """The tool does not fit the feature."""

    code = 305


class ArcError(PathError):
    """An arc is beyond what a MoveC can follow."""

    code = 306


class ToolChangeError(PathError):
    """The tool would have to be changed between two features."""

    code = 307


class ReachError(PathError):
    """A target is out of the robot's reach."""

    code = 310


class PathJointLimitError(PathError):
    """A target is reached only with a joint beyond its limit."""

    code = 311


class PathSingularityError(PathError):
    """The path passes too close to a singularity."""

    code = 312


class ConfigurationChangeError(PathError):
    """The path would need the robot to change its configuration while it mills."""

    code = 313


class JointSpeedError(PathError):
    """A joint would have to turn faster than it can."""

    code = 314


class AirMoveError(PathError):
    """A way through the air comes too close to the door."""

    code = 315


class HolderError(PathError):
    """A pocket is deeper than the mill reaches out of the spindle."""

    code = 316


class CorrectionLimitError(PathError):
    """The correction is larger than allowed."""

    code = 320


class CorrectionSettleError(PathError):
    """No correction puts the loaded tool back on the nominal path."""

    code = 321


class CycleTimeError(PathError):
    """The program takes longer than the cycle allows."""

    code = 330
