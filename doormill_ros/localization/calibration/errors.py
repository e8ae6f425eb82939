"""Why a calibration fails.

LocalizationError
`-- 230 CalibrationError
    |-- 231 TooFewPictures     too few usable pictures of the chessboard
    |-- 232 PoorlySpread       the pictures leave a parameter open
    `-- 233 BadCalibrationFile pictures or the list of moves cannot be read
"""

from __future__ import annotations

from doormill_ros.localization.errors import LocalizationError


class CalibrationError(LocalizationError):
    """Base of what can go wrong in a calibration."""

    code = 230


class TooFewPictures(CalibrationError):
    """Too few usable pictures."""

    code = 231


class PoorlySpread(CalibrationError):
    """The pictures leave a parameter open."""

    code = 232


class BadCalibrationFile(CalibrationError):
    """Pictures or the list of moves cannot be read."""

    code = 233
