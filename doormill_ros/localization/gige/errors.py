"""Why a GenICam camera gives no picture."""

from __future__ import annotations

from doormill_ros.localization.errors import LocalizationError


class GigeError(LocalizationError):
    """Base of what can go wrong with a GenICam camera."""

    code = 240


class CameraAbsent(GigeError):
    """No camera answers, or it has ceased to."""

    code = 242


class PictureLost(GigeError):
    """A picture did not come whole."""

    code = 243


AravisMissing = GigeError.row("AravisMissing", 241, "The library for GenICam cameras is not installed.")
CameraUnfit = GigeError.row("CameraUnfit", 244, "The camera cannot be set as it was asked to.")
NoPictureInTime = GigeError.row("NoPictureInTime", 250, "The camera gave no picture of a door in time.")
