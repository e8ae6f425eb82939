"""Limits at which a picture is refused, and what is known beside the picture."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import inf, nextafter
from pathlib import Path
from typing import Annotated

from doormill_ros.config import check, read
from doormill_ros.localization.errors import BadCameraFile
from doormill_ros.resources import resource
from doormill_ros.values import FiniteNumber, Section

FORM = "config/camera.yaml"
_Share = Annotated[float, FiniteNumber("a number from 0 to below 1", 0.0, nextafter(1.0, 0.0))]
#: What is larger is a slip of the pen, and its square is soon no number any more.
_Number = Annotated[float, FiniteNumber("a number from 0 to 1000000", 0.0, 1e6)]
Triple = tuple[_Number, _Number, _Number]


@dataclass(frozen=True)
class LocalizerSettings(Section):
    """The section `localizer` of config/camera.yaml.

    Attributes:
        squareness: Standard deviation of the angle of a well made door from a right angle [rad].
        max_age: Age from which a picture is stale [s].
        max_blur: Softest edge, standard deviation of its point spread [px].
        min_inlier_share: Share of each edge's visible length that must agree with its line, below 1.
        max_deviation: Largest standard deviation of y, z [m] and rotation [rad] that a picture may leave.
        mounting_deviation: Standard deviation of the camera's mounting in y, z [m] and rotation [rad].
        thickness_deviation: Standard deviation of the face's distance, from the door's thickness and its seat in
            the clamp [m].
        squareness_limit: Largest angle from a right angle of a door that is milled [rad].
        straightness_deviation: Standard deviation of a whole edge from the straight line of what shows of it [m].
        straightness_length: Length over which a bend that shows is taken to go on [m].
        straightness_limit: Largest rise of an edge over that length of a door that is milled [m].
        lens_deviation: Standard deviation of the focal length, as a share of it.
    """

    squareness: _Number
    max_age: _Number
    max_blur: _Number
    min_inlier_share: _Share
    max_deviation: Triple
    mounting_deviation: Triple
    thickness_deviation: _Number
    squareness_limit: _Number = 2.6e-3
    straightness_deviation: _Number = 0.0
    straightness_length: _Number = 0.4
    straightness_limit: _Number = 1.0e-4
    lens_deviation: _Number = 0.0

    def picture_only(self) -> LocalizerSettings:
        """These settings where all that no picture tells is known exactly: the covariance is the picture's own."""
        return replace(
            self,
            mounting_deviation=(0.0, 0.0, 0.0),
            thickness_deviation=0.0,
            straightness_deviation=0.0,
            lens_deviation=0.0,
        )

    def lens_in_question(self) -> LocalizerSettings:
        """As `picture_only`, where the camera is what is asked about: a wrong lens bends straight edges, too."""
        return replace(self.picture_only(), straightness_limit=inf)


@dataclass(frozen=True)
class _CameraFile(Section, extra="ignore"):
    """The other sections of the file belong to `camera.load_camera`."""

    localizer: LocalizerSettings


def load_settings(path: Path | None = None) -> LocalizerSettings:
    """Read the section `localizer` of config/camera.yaml, or of another file of the same form.

    Raises:
        BadCameraFile: A key is missing or unknown, or a value negative, too large or of the wrong length.
    """
    return read(path or resource(FORM), _CameraFile, BadCameraFile, f"compare it with {FORM}").localizer


def settings_of(document: object, name: str) -> LocalizerSettings:
    """What `load_settings` would read from a file of this plain value; `name` is what messages call it.

    Raises:
        BadCameraFile: As for `load_settings`.
    """
    return check(document, _CameraFile, BadCameraFile, name, f"compare it with {FORM}").localizer


@lru_cache(maxsize=1)
def shipped_settings() -> LocalizerSettings:
    """The settings of config/camera.yaml, read once."""
    return load_settings()
