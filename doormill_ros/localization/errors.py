"""Why a picture gives no pose."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class LocalizationError(DoormillError):
    """Base of every reason why there is no door pose."""

    code = 200


class NoEdge(LocalizationError):
    """Nothing straight stands where a door edge must be."""

    code = 201


class WrongEdge(LocalizationError):
    """Lines were found that are not the two edges of the door's face."""

    code = 202


class StalePicture(LocalizationError):
    """The picture was taken too long ago."""

    code = 208


class BadPicture(LocalizationError):
    """The picture is of a kind that is not read, or it is damaged."""

    code = 211


TooFewInliers = LocalizationError.row("TooFewInliers", 203, "Too little of an edge agrees with its line.")
OutOfRange = LocalizationError.row("OutOfRange", 204, "The door stands further off than the cell accepts.")
Blurred = LocalizationError.row("Blurred", 205, "The edges are too soft to be measured.")
OverExposed = LocalizationError.row("OverExposed", 206, "Too much of the picture is clipped at white.")
UnderExposed = LocalizationError.row("UnderExposed", 207, "The picture is too dark to hold an edge.")
CameraInfoMissing = LocalizationError.row("CameraInfoMissing", 209, "No intrinsics came with the picture.")
CameraInfoSize = LocalizationError.row("CameraInfoSize", 210, "The intrinsics are of another picture size.")
BadDoorFace = LocalizationError.row("BadDoorFace", 213, "The door's width or thickness is that of no door.")
BadCameraInfo = LocalizationError.row(
    "BadCameraInfo",
    214,
    "The intrinsics that came are not those of the camera that the cell was calibrated with.",
)
CameraMoved = LocalizationError.row(
    "CameraMoved", 215, "The camera no longer stands or sees as it was calibrated."
)
MarksMissing = LocalizationError.row(
    "MarksMissing", 216, "The cell's marks are not seen well enough to check the camera."
)
ProcessedPicture = LocalizationError.row(
    "ProcessedPicture", 217, "The camera has sharpened the picture or otherwise altered it."
)
NoDoor = LocalizationError.row(
    "NoDoor", 218, "What looks like a door is in the picture of the empty clamp too."
)
StaleEmptyClamp = LocalizationError.row(
    "StaleEmptyClamp",
    219,
    "The picture of the empty clamp is no longer what the camera sees beside the door.",
)
BadCameraFile = LocalizationError.row("BadCameraFile", 212, "A key is missing or a value is out of bounds.")
BowedEdge = LocalizationError.row(
    "BowedEdge", 251, "What shows of an edge bends more than a door that is milled may."
)
