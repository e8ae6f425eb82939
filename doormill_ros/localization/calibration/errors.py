"""Why a calibration fails."""

from __future__ import annotations

from doormill_ros.localization.errors import LocalizationError


class CalibrationError(LocalizationError):
    """Base of what can go wrong in a calibration."""

    code = 230


TooFewPictures = CalibrationError.row("TooFewPictures", 231, "Too few usable pictures.")
PoorlySpread = CalibrationError.row("PoorlySpread", 232, "The pictures leave a parameter open.")
BadCalibrationFile = CalibrationError.row("BadCalibrationFile", 233, "Pictures or the moves cannot be read.")
NothingKept = CalibrationError.row("NothingKept", 234, "There is no such old calibration to put back.")
DoorInClamp = CalibrationError.row(
    "DoorInClamp", 235, "A door seems to stand in what is to be the empty clamp."
)
