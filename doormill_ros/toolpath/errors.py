"""Errors of toolpaths, their correction and the whole-door checks."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class PathError(DoormillError):
    """No milling program can be made, and the sentence says why."""

    code = 300


class PathJointLimitError(PathError):
    """A target is reached only with a joint beyond its limit."""

    code = 311


class PathSingularityError(PathError):
    """The path passes too close to a singularity."""

    code = 312


class ConfigurationChangeError(PathError):
    """The path would need the robot to change its configuration while it mills."""

    code = 313


class AirMoveError(PathError):
    """A way through the air comes too close to something."""

    code = 315


class BodyContactError(PathError):
    """The arm would touch something while the tool is in a feature."""

    code = 317


class NoWayError(PathError):
    """No way leads from one posture to another without touching something."""

    code = 318


PathSettingsError = PathError.row("PathSettingsError", 301, "A setting of the path generator is impossible.")
DoorPoseError = PathError.row("DoorPoseError", 302, "The door stands where the cell does not mill.")
NothingToMillError = PathError.row("NothingToMillError", 303, "There is no feature to mill.")
ProgramSizeError = PathError.row("ProgramSizeError", 304, "More targets than a controller keeps.")
ToolFitError = PathError.row("ToolFitError", 305, "The tool does not fit the feature.")
ArcError = PathError.row("ArcError", 306, "An arc is beyond what a MoveC can follow.")
ToolChangeError = PathError.row("ToolChangeError", 307, "The tool must be changed between two features.")
ToolLifeError = PathError.row("ToolLifeError", 308, "A tool would be worn before the door is milled.")
ToolLengthError = PathError.row(
    "ToolLengthError", 309, "A tool stands out of the spindle by another length than the paths are made for."
)
ToolPlaceError = PathError.row("ToolPlaceError", 323, "A tool stands in no place of the rack.")
ReachError = PathError.row("ReachError", 310, "A target is out of the robot's reach.")
JointSpeedError = PathError.row("JointSpeedError", 314, "A joint would have to turn faster than it can.")
HolderError = PathError.row("HolderError", 316, "A pocket is deeper than the mill reaches.")
HomeContactError = PathError.row("HomeContactError", 319, "The robot touches something where it is at home.")
CorrectionLimitError = PathError.row("CorrectionLimitError", 320, "The correction is larger than allowed.")
CorrectionSettleError = PathError.row(
    "CorrectionSettleError", 321, "No correction puts the tool back on its path."
)
ExpectedErrorError = PathError.row(
    "ExpectedErrorError", 322, "A wall is expected to be further off than its tolerance."
)
CycleTimeError = PathError.row("CycleTimeError", 330, "The program takes longer than the cycle allows.")
UnbackedHoleError = PathError.row(
    "UnbackedHoleError", 340, "A hole comes out where nothing keeps the wood from tearing out."
)
